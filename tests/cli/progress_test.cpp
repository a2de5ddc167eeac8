#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files.h"
#include "endless_render.h"
#include "run_castray.h"
#include "screen.h"
#include "terminal.h"
#include "words.h"

using namespace castray;
using Catch::Contains;
using test::endless_render;

TEST_CASE("progress is a bar, lines, or nothing") {
  const TemporaryFolder folder;
  const auto progress = [&](const char* mode) {
    return run_castray(
               endless_render({"-o", "x.pfm", "--time-limit", "3", "--threads", "1", "--progress", mode}),
               folder.path())
        .err;
  };
  const std::string bar = progress("bar"), lines = progress("lines"), automatic = progress("auto");
  CHECK_THAT(bar, Contains("\r[") && Contains(" %") && Contains("elapsed") && Contains("left") &&
                      Contains("Msamples/s"));
  CHECK_THAT(lines, Contains("elapsed") && Contains("left") && !Contains("\r"));
  CHECK_THAT(automatic, Contains("elapsed") && !Contains("\r"));  // stderr is no terminal here
  CHECK_THAT(progress("off"), !Contains("elapsed"));
}

TEST_CASE("on a terminal the bar rewrites one line, however narrow, and ends at 100 %") {
  for (const int columns : {20, 40, 120}) {
    const TemporaryFolder folder;
    Terminal terminal(columns);
    const RunResult run = run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "32x32",
                                       "--time-limit", "0.8", "--threads", "1", "-o", "x.pfm"},
                                      {.folder = folder.path(), .error_file = terminal.name()});
    CHECK(run.exit_code == 0);
    const std::string all = terminal.text();
    const std::string bar = all.substr(0, all.find("\r\n"));
    Screen screen(columns, 24);
    screen.show(bar);
    CAPTURE(all);
    CHECK_FALSE(screen.wrapped());
    CHECK_THAT(screen.line(0), Contains("100.0 %"));
    CHECK(std::count(bar.begin(), bar.end(), '\r') >= 2);
  }
}

TEST_CASE("lines come ever more seldom, and end at 100 %") {
  const TemporaryFolder folder;
  const RunResult run =
      run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "32x32", "--time-limit",
                   "3.5", "--threads", "1", "--progress", "lines", "-o", "x.pfm"},
                  folder.path());
  std::istringstream lines(run.err);
  std::string line, last;
  int count = 0;
  while (std::getline(lines, line))
    if (line.find(" elapsed ") != std::string::npos) ++count, last = line;
  CAPTURE(run.err);
  CHECK(count >= 2);
  CHECK(count <= 4);
  CHECK_THAT(last, Contains("100.0 %"));
}

namespace {

/// A triangle's OBJ that the program waits for on its standard input, until that is written.
class SlowScene {
 public:
  explicit SlowScene(const TemporaryFolder& folder) : file_(folder / "input") {
    if (mkfifo(file_.c_str(), 0600) != 0) throw std::runtime_error("cannot make a pipe");
  }
  std::string file() const { return file_; }
  void write() const { std::ofstream(file_) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"; }

 private:
  std::string file_;
};

std::vector<std::string> render_of_input(const std::string& mode) {
  return {"render", "-", "--size", "8x8", "--spp", "1", "--progress", mode, "-o", "x.pfm"};
}

struct JsonProgress {
  std::vector<std::string> phases;  ///< in their order, each once
  std::vector<double> fractions;    ///< of the rendering
};

JsonProgress json_progress(const std::string& text) {
  JsonProgress all;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() != '{') continue;
    const auto object = nlohmann::json::parse(line);
    const std::string phase = object.at("phase");
    CHECK(object.at("elapsed_seconds") >= 0);
    if (all.phases.empty() || all.phases.back() != phase) all.phases.push_back(phase);
    if (phase == "rendering") all.fractions.push_back(object.at("fraction"));
  }
  return all;
}

}  // namespace

TEST_CASE("progress json is an object a line, of each phase, the last of the render of the whole") {
  const TemporaryFolder folder;
  const RunResult run =
      run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "32x32", "--time-limit",
                   "1.2", "--threads", "1", "--progress", "json", "-o", "x.pfm"},
                  folder.path());
  const auto [phases, fractions] = json_progress(run.err);
  CHECK(phases == std::vector<std::string>{"reading " CASTRAY_ROOT "/scenes/cornell_box.json",
                                           "preparing 32 triangles", "rendering", "writing"});
  CHECK(fractions.size() >= 2);
  CHECK(std::is_sorted(fractions.begin(), fractions.end()));
  CHECK(fractions.back() == 1);
}

TEST_CASE("each phase of a render of a moment is told to programs, and none to people") {
  const TemporaryFolder folder;
  write_file(folder / "one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto progress = [&](const char* mode) {
    return run_castray({"render", "one.obj", "--size", "8x8", "--spp", "1", "--progress", mode},
                       folder.path())
        .err;
  };
  const auto [phases, fractions] = json_progress(progress("json"));
  CHECK(phases ==
        std::vector<std::string>{"reading one.obj", "preparing 1 triangles", "rendering", "writing"});
  CHECK(fractions.back() == 1);
  for (const char* mode : {"bar", "lines"})
    CHECK_THAT(progress(mode), !Contains("reading") && !Contains("preparing"));
}

TEST_CASE("a scene that takes long to read is told in lines, and in a bar that fits") {
  const TemporaryFolder folder;
  const SlowScene scene(folder);
  {
    CastrayProcess process(render_of_input("lines"), {.folder = folder.path(), .input_file = scene.file()});
    std::ofstream held(scene.file());
    REQUIRE(process.wait_until([&] { return count_of(process.err(), "castray: reading -  0:0") == 1; }));
    scene.write();
    held.close();
    CHECK(process.wait().exit_code == 0);
  }
  Terminal terminal(20);
  CastrayProcess process(
      render_of_input("bar"),
      {.folder = folder.path(), .input_file = scene.file(), .error_file = terminal.name()});
  std::ofstream held(scene.file());
  REQUIRE(process.wait_until([&] { return count_of(terminal.text_so_far(), "\rcastray: reading") >= 2; }));
  Screen screen(20, 24);
  screen.show(terminal.text_so_far());
  CHECK_FALSE(screen.wrapped());
  CHECK_THAT(screen.line(0), Contains("castray: reading -"));
  scene.write();
  held.close();
  CHECK(process.wait().exit_code == 0);
}
