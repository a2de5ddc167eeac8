#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "run_castray.h"
#include "temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

void write(const fs::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

/// A folder with a scene in it, "s.json", whose image is 8 x 8 pixels, and two of its images, "i.pfm" and
/// "i.png".
class Folder {
 public:
  Folder() {
    write(folder / "t.obj", "v -1 -1 0\nv 0 1 0\nv 1 -1 0\nf 1 2 3\n");
    write(folder / "s.json", R"({ "image": { "width": 8, "height": 8 }, "render": { "spp": 1, "threads": 1 },
      "materials": { "m": { "type": "diffuse", "ke": [1, 1, 1], "two_sided_emission": true } },
      "meshes": [ { "obj": "t.obj", "material": "m" } ] })");
    for (const char* suffix : {".pfm", ".png", ".exr", ".hdr", ".ppm", ".film"})
      outputs.insert(outputs.end(), {"-o", "i" + std::string(suffix)});
    REQUIRE(run(outputs).exit_code == 0);
  }

  RunResult run(const Words& words, const RunSettings& settings = {}) const {
    RunSettings here = settings;
    here.folder = folder.path();
    return run_castray(words, here);
  }
  void cut(const std::string& from, const std::string& to, double part) const {
    const std::string content = file_content(folder / from);
    write(folder / to,
          content.substr(0, static_cast<std::size_t>(part * static_cast<double>(content.size()))));
  }

  TemporaryFolder folder;
  Words outputs{"render", "s.json", "-q"};
};

/// What is done first, the words behind "castray", and what must be in the one line of error.
struct Case {
  std::string what;
  std::function<void(const Folder&)> prepare;
  Words words;
  std::string message;
  RunSettings settings{};
};

Case cut_image(const std::string& suffix, const std::string& message) {
  return {"a cut " + suffix,
          [suffix](const Folder& f) { f.cut("i" + suffix, "cut" + suffix, 0.6); },
          {"convert", "cut" + suffix, "-o", "x.pfm"},
          "cut" + suffix + ": " + message};
}

Case forged(const std::string& name, const std::string& content, const std::string& message) {
  return {"forged " + name,
          [=](const Folder& f) { write(f.folder / name, content); },
          {"convert", name, "-o", "x.pfm"},
          name + ": " + message};
}

Case forged_film(const std::string& name, const std::string& window, const std::string& message) {
  return forged(name, "castray film 1\n{\"window\": " + window + "}\n",
                "has a corrupt header: [json.exception." + message);
}

void nothing(const Folder&) {}

const std::vector<Case> cases = {
    // What is no file
    {"missing scene", nothing, {"info", "gone.json"}, "gone.json: does not exist"},
    {"missing file of no kind", nothing, {"info", "gone"}, "gone: does not exist"},
    {"a folder as scene",
     [](const Folder& f) { fs::create_directory(f.folder / "d.json"); },
     {"info", "d.json"},
     "d.json: is a folder"},
    {"links in a circle",
     [](const Folder& f) {
       fs::create_symlink("a.json", f.folder / "b.json");
       fs::create_symlink("b.json", f.folder / "a.json");
     },
     {"info", "a.json"},
     "a.json: cannot be read: Too many levels of symbolic links"},
    {"an OBJ that is a circle of links",
     [](const Folder& f) {
       fs::create_symlink("t2.obj", f.folder / "t2.obj");
       write(f.folder / "c.json", R"({ "meshes": [ { "obj": "t2.obj" } ] })");
     },
     {"info", "c.json"},
     "c.json:1:24: no such file: t2.obj"},
    {"a name too long", nothing, {"info", std::string(300, 'x') + ".json"}, "File name too long"},
    {"a file where a folder must be",
     nothing,
     {"info", "s.json/x.json"},
     "s.json/x.json: cannot be read: Not a directory"},
    {"a name that is not UTF-8", nothing, {"info", "\xff\xfe.json"}, "does not exist"},
    {"a name with a line break", nothing, {"info", "a\nb.json"}, "does not exist"},
    {"a device without end",
     [](const Folder& f) { fs::create_symlink("/dev/zero", f.folder / "z.obj"); },
     {"info", "z.obj"},
     "z.obj: does not end; give a regular file"},
    {"a file whose reading fails",
     [](const Folder& f) { fs::create_symlink("/proc/self/mem", f.folder / "r.obj"); },
     {"info", "r.obj"},
     "r.obj: cannot be read: Input/output error"},
    {"a file longer than memory",
     [](const Folder& f) {
       write(f.folder / "l.obj", "");
       fs::resize_file(f.folder / "l.obj", std::uintmax_t{1} << 42);
     },
     {"info", "l.obj"},
     "l.obj: is longer than this machine's memory"},
    // Strange scenes
    {"only a byte order mark",
     [](const Folder& f) { write(f.folder / "m.json", "\xef\xbb\xbf"); },
     {"info", "m.json"},
     "m.json:1:1: not valid JSON"},
    {"nothing",
     [](const Folder& f) { write(f.folder / "e.json", ""); },
     {"info", "e.json"},
     "e.json:1:1: not valid JSON"},
    {"not UTF-8",
     [](const Folder& f) { write(f.folder / "u.json", "{ \"\xff\": 1 }"); },
     {"info", "u.json"},
     "u.json:1:4: not valid JSON: syntax error while parsing object key - invalid string: ill-formed UTF-8 "
     "byte"},
    {"UTF-16",
     [](const Folder& f) { write(f.folder / "u.json", std::string("\xff\xfe{\0}\0", 6)); },
     {"info", "u.json"},
     "u.json: is UTF-16; save it as UTF-8"},
    {"nested deeply",
     [](const Folder& f) { write(f.folder / "n.json", std::string(1'000'000, '[')); },
     {"info", "n.json"},
     "n.json:1:65: nested deeper than 64 levels"},
    {"a million values",
     [](const Folder& f) {
       std::string c = "[1";
       for (int i = 0; i < 1'000'001; ++i) c += ",1";
       write(f.folder / "v.json", c + "]");
     },
     {"info", "v.json"},
     "more than 1000000 values"},
    {"70000 materials",
     [](const Folder& f) {
       std::string c = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
       for (int i = 0; i < 70000; ++i) c += "usemtl m" + std::to_string(i) + "\nf 1 2 3\n";
       write(f.folder / "m.obj", c);
     },
     {"info", "m.obj"},
     "m.obj:131075:8: more than 65535 materials"},
    {"a face of two million corners",
     [](const Folder& f) {
       std::string c = "v 0 0 0\nf";
       for (int i = 0; i < 2'000'000; ++i) c += " 1";
       write(f.folder / "p.obj", c);
     },
     {"info", "p.obj"},
     "p.obj:2:2097155: a face of more than 1048576 corners"},
    // Images
    cut_image(".png", "is truncated or corrupt"),
    cut_image(".pfm", ""),
    cut_image(".ppm", ""),
    cut_image(".hdr", ""),
    cut_image(".exr", ""),
    cut_image(".film", ""),
    forged("big.ppm", "P6 65536 4096 255\n", "the file is too short for its size in pixels"),
    forged("huge.pfm", "PF\n2147483647 2147483647\n-1\n", "bad width '2147483647'"),
    forged("none.pfm", "PF\n0 7\n-1\n", ""),
    forged("minus.ppm", "P6 -3 4 255\n", ""),
    forged("word.ppm", "P6 a b\n", ""),
    forged("empty.png", "", "is not a PNG file"),
    forged("empty.exr", "", "cannot be read as OpenEXR"),
    forged("long.png", std::string("\x89PNG\r\n\x1a\n\x7f\xff\xff\xf0tEXt", 16) + std::string(20, 'x'),
           "is truncated or corrupt"),
    forged_film("fractions.film", "[4, 4, 0, 0, 2.5, 2]", "other_error.500] bad number"),
    forged_film("minus.film", "[4, 4, -1, 0, 2, 2]", "other_error.500] bad number"),
    forged_film("huge.film", "[4, 4e105, 1, 1, 3, 3]", "other_error.500] bad number"),
    forged_film("long.film", "[4294967300, 4, 0, 0, 4, 4]", "other_error.500] bad number"),
    forged_film("few.film", "[4, 4]", "out_of_range.401] array index 2 is out of range"),
    {"images of different size",
     [](const Folder& f) { write(f.folder / "w.pfm", "PF\n1 1\n-1\n" + std::string(12, '\0')); },
     {"compare", "i.pfm", "w.pfm"},
     ""},
    {"8 bits against floats", nothing, {"compare", "i.png", "i.pfm"}, ""},
    {"a film twice", nothing, {"merge", "i.film", "i.film", "-o", "x.film"}, "sample 0"},
    {"an image merged", nothing, {"merge", "i.film", "i.pfm", "-o", "x.film"}, "i.pfm"},
    {"a checkpoint of another render",
     nothing,
     {"render", "s.json", "-q", "--seed", "1", "--checkpoint", "i.film", "--resume", "-o", "x.png"},
     "of another render: seed=0 against seed=1;"},
    // Outputs
    {"a full disk",
     [](const Folder& f) { fs::create_symlink("/dev/full", f.folder / "full.png"); },
     {"render", "s.json", "-q", "-o", "full.png"},
     "full.png: "},
    {"a disk that fills while an image is written",
     nothing,
     {"render", "s.json", "-q", "--size", "64x64", "-o", "x.pfm"},
     "x.pfm: cannot be written: File too large; free some space",
     {.largest_file = 4096}},
    {"a full disk for statistics",
     [](const Folder& f) { fs::create_symlink("/dev/full", f.folder / "full.json"); },
     {"render", "s.json", "-q", "-o", "x.png", "--stats", "full.json"},
     "full.json: "},
    {"a write-protected target",
     [](const Folder& f) { fs::permissions(f.folder / "i.png", fs::perms::owner_read); },
     {"render", "s.json", "-q", "-o", "i.png"},
     "i.png: "},
    {"a folder as target",
     [](const Folder& f) { fs::create_directory(f.folder / "d.png"); },
     {"render", "s.json", "-q", "-o", "d.png"},
     "d.png: is a folder"},
    {"stacks too small for a render",
     nothing,
     {"render", "s.json", "-q", "-o", "x.png"},
     // how many depends on the OpenMP runtime
     " KiB are too small; set `ulimit -s 512`, and OMP_STACKSIZE to 512K if it is set",
     {.variables = {{"OMP_STACKSIZE", "16k"}}}},
    {"a target in a file", nothing, {"render", "s.json", "-q", "-o", "s.json/x.png"}, "s.json/x.png: "},
};

}  // namespace

TEST_CASE("a faulty file gives one line, exit code 2, and takes little memory") {
  for (const Case& faulty : cases) {
    INFO(faulty.what);
    const Folder folder;
    faulty.prepare(folder);
    const RunResult outcome = folder.run(faulty.words, faulty.settings);
    INFO(outcome.err);
    CHECK(outcome.err.starts_with("castray: error: "));
    CHECK(outcome.err.find(faulty.message) != std::string::npos);
    CHECK(outcome.err.size() < 600);
    CHECK(outcome.error_lines() == 1);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.peak_kilobytes < 700'000);
    CHECK(std::ranges::none_of(folder.folder.names(),
                               [](const std::string& n) { return n.ends_with(".tmp"); }));
  }
}

TEST_CASE("the environment changes no image") {
  const Folder folder;
  const std::string image = file_content(folder.folder / "i.pfm");
  const std::vector<std::pair<std::string, std::string>> variables = {
      {"LC_ALL", "de_DE.UTF-8"},  {"LC_ALL", "nonsense"}, {"OMP_NUM_THREADS", "7"}, {"OMP_DYNAMIC", "true"},
      {"OMP_SCHEDULE", "static"}, {"TMPDIR", "/gone"},    {"OMP_THREAD_LIMIT", "1"}};
  for (const auto& variable : variables) {
    INFO(variable.first << '=' << variable.second);
    fs::remove(folder.folder / "i.pfm");
    const RunResult outcome = folder.run(folder.outputs, {.variables = {variable}});
    CHECK(outcome.exit_code == 0);
    CHECK(outcome.err == "");
    CHECK((file_content(folder.folder / "i.pfm") == image));
  }
}

TEST_CASE("a line of 200 MB is read, or refused, in bounded memory", "[long]") {
  const Folder folder;
  const auto big = [](const std::string& start, const std::string& repeated) {
    std::string content = start;
    while (content.size() < 200'000'000) content += repeated;
    return content + "\n";
  };
  write(folder.folder / "comment.obj", big("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n#", "long comment "));
  CHECK(folder.run({"info", "comment.obj"}).exit_code == 0);
  write(folder.folder / "number.obj", big("v 0 0 ", "1234567890"));
  write(folder.folder / "text.json", big("{ \"", "abcdefghij"));
  for (const char* name : {"number.obj", "text.json"}) {
    const RunResult outcome = folder.run({"info", name});
    INFO(outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.error_lines() == 1);
    CHECK(outcome.err.size() < 600);
    CHECK(outcome.peak_kilobytes < 1'500'000);
  }
}
