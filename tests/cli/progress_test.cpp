#include <catch2/catch.hpp>

#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "endless_render.h"
#include "run_castray.h"

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

namespace {

/// A terminal of some columns; what is written to it is collected until this object dies.
class Terminal {
 public:
  explicit Terminal(int columns) : master_(posix_openpt(O_RDWR | O_NOCTTY)) {
    grantpt(master_);
    unlockpt(master_);
    slave_ = open(ptsname(master_), O_RDWR | O_NOCTTY);
    const winsize size{24, static_cast<unsigned short>(columns), 0, 0};
    ioctl(slave_, TIOCSWINSZ, &size);
    reader_ = std::thread([this] {
      char buffer[4096];
      for (ssize_t n; (n = read(master_, buffer, sizeof buffer)) > 0;)
        text_.append(buffer, static_cast<std::size_t>(n));
    });
  }
  ~Terminal() { text(); }
  std::string name() const { return ptsname(master_); }
  /// All that was written, once its writers have ended.
  const std::string& text() {
    if (slave_ >= 0) close(slave_), slave_ = -1;
    if (reader_.joinable()) reader_.join(), close(master_);
    return text_;
  }

 private:
  int master_, slave_ = -1;
  std::string text_;
  std::thread reader_;
};

}  // namespace

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
    std::istringstream states(bar);
    std::string state, last;
    while (std::getline(states, state, '\r')) {
      CHECK(static_cast<int>(state.size()) < columns + static_cast<int>(std::string("\x1b[K").size()));
      if (!state.empty()) last = state;
    }
    CAPTURE(all);
    CHECK_THAT(last, Contains("100.0 %"));
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

TEST_CASE("progress json is an object a line, the last one of the whole") {
  const TemporaryFolder folder;
  const RunResult run =
      run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "32x32", "--time-limit",
                   "1.2", "--threads", "1", "--progress", "json", "-o", "x.pfm"},
                  folder.path());
  std::istringstream lines(run.err);
  std::string line;
  double fraction = 0;
  int count = 0;
  while (std::getline(lines, line)) {
    if (line.empty() || line.front() != '{') continue;
    const auto object = nlohmann::json::parse(line);
    CHECK(object["fraction"] >= fraction);
    fraction = object["fraction"];
    ++count;
  }
  CHECK(count >= 2);
  CHECK(fraction == 1);
}
