// The forms in which people write command lines, on every command.
#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>

#include "cli/argument_forms.h"
#include "core/files.h"
#include "run_castray.h"
#include "test_image.h"

using namespace castray;
using Catch::Contains;
using Words = std::vector<std::string>;

namespace {

const Words small = {"--size", "8x8", "--spp", "1"};

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// A folder with a scene, its triangle, an image and a film.
struct Files {
  TemporaryFolder folder;

  Files() {
    write_file(folder / "t.obj", "v -1 -1 0\nv 0 1 0\nv 1 -1 0\nf 1 2 3\n");
    write_file(folder / "s.json", R"({ "meshes": [ { "obj": "t.obj" } ] })");
    write_image(folder / "a.pfm", test_image(8, 8));
    CHECK(run(with({"render", "s.json", "-q", "-o", "f.film"}, small)).exit_code == 0);
  }
  RunResult run(const Words& words) const { return run_castray(words, folder.path()); }
  RunResult run_with_input(const Words& words, const std::string& file) const {
    return run_castray(words, RunSettings{.folder = folder.path(), .input_file = folder / file});
  }
};

}  // namespace

TEST_CASE("words that follow -o FILE are outputs where they can be no inputs") {
  const auto plain = [](const Words& words) { return cli::plain_arguments(words); };
  const Words one_each = {"render", "s.json", "-o", "a.png", "-o", "b.exr"};
  CHECK(plain({"render", "s.json", "-o", "a.png", "b.exr"}) == one_each);
  CHECK(plain({"render", "s.json", "-o=a.png", "b.exr"}) == one_each);
  CHECK(plain(one_each) == one_each);
  CHECK(plain({"render", "-o", "a.png", "s.json"}) == Words{"render", "-o", "a.png", "s.json"});
  CHECK(plain({"render", "-o", "a.png", "-"}) == Words{"render", "-o", "a.png", "-"});
  CHECK(plain({"convert", "-o", "a.png", "b.exr"}) == Words{"convert", "-o", "a.png", "b.exr"});
  CHECK(plain({"convert", "b.exr", "--exposure", "1", "-o", "a.png", "c.pfm"}) ==
        Words{"convert", "b.exr", "--exposure", "1", "-o", "a.png", "-o", "c.pfm"});
  CHECK(plain({"merge", "a.film", "-o", "c.film", "b.film"}) ==
        Words{"merge", "a.film", "-o", "c.film", "b.film"});
  CHECK(plain({"merge", "a.film", "-o", "c.film", "c.png"}) ==
        Words{"merge", "a.film", "-o", "c.film", "-o", "c.png"});
  CHECK(plain({"compare", "a.png", "--max", "mse=1", "b.png"}) ==
        Words{"compare", "a.png", "--max", "mse=1", "b.png"});
}

TEST_CASE("several outputs and -o=FILE are written as asked") {
  const Files files;
  CHECK(files.run(with({"render", "s.json", "-q", "-o", "x.png", "y.pfm", "-o=z.exr"}, small)).exit_code ==
        0);
  CHECK(files.run({"convert", "y.pfm", "-v", "-o", "u.png", "v.pfm"}).err == "wrote u.png\nwrote v.pfm\n");
  CHECK(files.run({"merge", "f.film", "-o=m.film", "m.png", "-v"}).err == "wrote m.film\nwrote m.png\n");
  CHECK(read_image(files.folder / "x.png").image.pixels == read_image(files.folder / "u.png").image.pixels);
  CHECK(read_file(files.folder / "y.pfm") == read_file(files.folder / "v.pfm"));
  CHECK(files.folder.names() == Words{"a.pfm", "f.film", "m.film", "m.png", "s.json", "t.obj", "u.png",
                                      "v.pfm", "x.png", "y.pfm", "z.exr"});
}

TEST_CASE("a scene is read from the standard input, JSON or OBJ") {
  const Files files;
  for (const std::string scene : {"s.json", "t.obj"}) {
    INFO(scene);
    CHECK(files.run(with({"render", scene, "-q", "-o", "named.pfm"}, small)).exit_code == 0);
    CHECK(files.run_with_input(with({"render", "-", "-q", "-o", "piped.pfm"}, small), scene).exit_code == 0);
    CHECK(read_file(files.folder / "named.pfm") == read_file(files.folder / "piped.pfm"));
    CHECK_THAT(files.run_with_input({"info", "-"}, scene).out, Contains("triangles  1"));
  }
  write_file(files.folder / "wrong.json", "{\n  \"meshs\": []\n}\n");
  CHECK_THAT(files.run_with_input({"info", "-"}, "wrong.json").err, Contains("-:2:3: unknown key 'meshs'"));
  CHECK(files.run_with_input(with({"render", "-", "-q"}, small), "s.json").exit_code == 0);
  CHECK(std::filesystem::exists(files.folder / "scene.png"));
}

TEST_CASE("a named pipe is waited for, and gets the bytes of a file") {
  const Files files;
  const std::filesystem::path pipe = files.folder / "pipe.exr";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  auto read = std::async(std::launch::async, [&pipe] { return read_file(pipe); });
  CHECK(files.run(with({"render", "s.json", "-q", "-o", "pipe.exr"}, small)).exit_code == 0);
  CHECK(files.run(with({"render", "s.json", "-q", "-o", "file.exr"}, small)).exit_code == 0);
  CHECK(read.get() == read_file(files.folder / "file.exr"));
}

TEST_CASE("statistics go to the standard output") {
  const Files files;
  const RunResult result = files.run(with({"render", "s.json", "-o", "x.pfm", "--stats", "-"}, small));
  CHECK(nlohmann::json::parse(result.out)["width"] == 8);
  CHECK_THAT(result.err, Contains("Render complete"));
}

TEST_CASE("every command takes -q, -v and -t") {
  const Files files;
  const Words commands[] = {with({"render", "s.json", "-o", "x.pfm"}, small),
                            {"compare", "a.pfm", "a.pfm"},
                            {"accept", "a.pfm", "b.pfm"},
                            {"bench", "s.json", "--size", "8x8", "--spp", "1", "--seeds", "1",
                             "--reference-spp", "2", "--cache", "cache"},
                            {"info", "s.json"},
                            {"merge", "f.film", "-o", "m.png"},
                            {"convert", "a.pfm", "-o", "c.png"},
                            {"completions", "bash"}};
  for (const Words& command : commands) {
    INFO(command.front());
    CHECK(files.run(with(command, {"--quiet", "--verbose", "--threads", "1"})).exit_code == 0);
    const RunResult quiet = files.run(with(command, {"-q", "-t", "2"}));
    CHECK(quiet.exit_code == 0);
    CHECK(quiet.err == "");
    CHECK_THAT(files.run({"help", command.front()}).out, Contains("-q,--quiet") && Contains("-v,--verbose"));
    CHECK(files.run({"help", command.front()}).out == files.run({command.front(), "--help"}).out);
  }
  CHECK(files.run({"help"}).out == files.run({"--help"}).out);
}

TEST_CASE("quiet silences warnings, verbose says more") {
  const Files files;
  CHECK_THAT(files.run({"convert", "a.pfm", "-o", "c.png", "--tone", "gamma:2.2"}).err, Contains("darkens"));
  CHECK(files.run({"convert", "a.pfm", "-o", "c.png", "--tone", "gamma:2.2", "-q"}).err == "");
  for (const char* side : {"out", "references"})
    for (const char* name : {"a.pfm", "b.pfm"}) {
      std::filesystem::create_directory(files.folder / side);
      write_image(files.folder / side / name, test_image(8, 8));
    }
  const Words compare = {"compare", "out", "references", "--max", "mse=0"};
  CHECK_THAT(files.run(compare).out, !Contains("max_error"));
  CHECK_THAT(files.run(with(compare, {"-v"})).out, Contains("max_error") && Contains("2 of 2 images pass"));
  CHECK_THAT(files.run(compare).err, Contains("compared 2 of 2"));
  CHECK(files.run(with(compare, {"-q"})).err == "");
}

TEST_CASE("info takes several files of any kind") {
  const Files files;
  const RunResult result = files.run({"info", "s.json", "a.pfm", "f.film"});
  CHECK(result.exit_code == 0);
  CHECK_THAT(result.out, Contains("scene      s.json\n") && Contains("\nimage      a.pfm\n") &&
                             Contains("\nimage      f.film\n"));
}

TEST_CASE("messages that nobody can be told cost no image") {
  const Files files;
  const Words render = with({"render", "s.json", "-o", "x.pfm"}, small);
  REQUIRE(files.run(render).exit_code == 0);
  const std::string image = read_file(files.folder / "x.pfm");
  std::filesystem::remove(files.folder / "x.pfm");
  CHECK(
      run_castray(render, RunSettings{.folder = files.folder.path(), .error_file = "/dev/full"}).exit_code ==
      0);
  CHECK(read_file(files.folder / "x.pfm") == image);
  for (const std::string streams : {"2>&-", "<&- >&- 2>&-", "2>&1 | true"}) {
    CAPTURE(streams);
    std::filesystem::remove(files.folder / "x.pfm");
    const std::string command = "cd '" + files.folder.path().string() +
                                "' && " CASTRAY_PROGRAM " render s.json --size 8x8 --spp 1 -o x.pfm " +
                                streams;
    CHECK(std::system(command.c_str()) == 0);
    CHECK(read_file(files.folder / "x.pfm") == image);
  }
}

TEST_CASE("no output replaces another one, or the scene") {
  const Files files;
  const std::string scene = read_file(files.folder / "s.json");
  const auto refused = [&](const Words& words, const std::string& message) {
    CAPTURE(message);
    const RunResult result = files.run(words);
    CHECK(result.exit_code == 2);
    CHECK(result.err == "castray: error: " + message + "\n");
  };
  const std::string twice = ": more than one output goes to this file; give the others other names";
  refused(with({"render", "s.json", "-o", "x.png", "--stats", "./x.png"}, small), "./x.png" + twice);
  refused(with({"render", "s.json", "-o", "x.film", "--checkpoint", "x.film"}, small), "x.film" + twice);
  refused({"convert", "a.pfm", "-o", "x.png", "-o", "x.png"}, "x.png" + twice);
  refused({"compare", "a.pfm", "a.pfm", "--json", "r", "--html", "r"}, "r" + twice);
  refused(with({"render", "s.json", "-q", "--stats", "./s.json"}, small),
          "./s.json: is the scene itself; give another name");
  CHECK(read_file(files.folder / "s.json") == scene);
}

TEST_CASE("what a scene's own defaults cannot be is told at its place by every command that renders") {
  const Files files;
  write_file(files.folder / "d.json",
             "{ \"render\": {\n \"isa\": \"odd\" }, \"meshes\": [ { \"obj\": \"t.obj\" } ] }");
  for (const char* command : {"render", "bench", "serve"})
    CHECK_THAT(files.run({command, "d.json", "-q"}).err,
               Catch::StartsWith("castray: error: d.json:2:2: --isa odd: unknown"));
}

TEST_CASE("what every command cannot write to the standard output is an error") {
  const Files files;
  const Words commands[] = {with({"render", "s.json", "-q", "-o", "-"}, small),
                            with({"render", "s.json", "-q", "-o", "x.pfm", "--stats", "-"}, small),
                            {"compare", "a.pfm", "a.pfm"},
                            {"compare", "a.pfm", "a.pfm", "--junit", "-"},
                            {"accept", "a.pfm", "b.pfm"},
                            {"bench", "s.json", "-q", "--size", "8x8", "--spp", "1", "--seeds", "1",
                             "--reference-spp", "2", "--cache", "cache"},
                            {"info", "s.json"},
                            {"merge", "f.film", "-o", "film:-"},
                            {"convert", "a.pfm", "-o", "exr:-"},
                            {"completions", "man"},
                            {"help", "render"},
                            {"--version"}};
  for (const Words& command : commands) {
    INFO(command.front());
    const RunResult result =
        run_castray(command, RunSettings{.folder = files.folder.path(), .output_file = "/dev/full"});
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Contains("cannot be written") && Contains("No space left on device"));
  }
}

TEST_CASE("one OBJ that is used many times is warned of once") {
  const Files files;
  write_file(files.folder / "m.obj", "mtllib gone.mtl\nusemtl red\nv -1 -1 0\nv 0 1 0\nv 1 -1 0\nf 1 2 3\n");
  std::string meshes;
  for (int i = 0; i < 36; ++i)
    meshes += (i ? ", " : "") + std::string(R"({ "obj": "m.obj", "transform": [ { "translate": [)") +
              std::to_string(3 * i) + ", 0, 0] } ] }";
  write_file(files.folder / "many.json", "{ \"meshes\": [ " + meshes + " ] }");
  const RunResult info = files.run({"info", "many.json"});
  CHECK(info.exit_code == 0);
  CHECK_THAT(info.out, Contains("triangles  36") && Contains("materials  1\n"));
  std::size_t warnings = 0;
  for (std::size_t at = 0; (at = info.out.find("gone.mtl", at)) != std::string::npos; ++at) ++warnings;
  CHECK(warnings == 1);
}

TEST_CASE("nothing is coloured") {
  const Files files;
  for (const Words& command : {Words{"compare", "a.pfm", "a.pfm"}, Words{"info", "gone"},
                               with({"render", "s.json", "-o", "x.pfm", "--progress", "lines"}, small)}) {
    const RunResult result = files.run(command);
    CHECK_THAT(result.out + result.err, !Contains("\x1b"));
  }
}
