#include <catch2/catch.hpp>

#include "endless_render.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;
using test::endless_render;

TEST_CASE("progress is a bar, lines, or nothing") {
  const TemporaryFolder folder;
  const auto progress = [&](const char* mode) {
    return run_castray(endless_render({"-o", "x.pfm", "--time-limit", "1.3", "--progress", mode}),
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
