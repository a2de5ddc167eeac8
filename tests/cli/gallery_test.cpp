#include <catch2/catch.hpp>

#include <cstdlib>

#include "run_castray.h"

namespace fs = std::filesystem;

TEST_CASE("every scene of the gallery renders once its parts are made", "[long]") {
  const TemporaryFolder checkout;
  fs::create_directory(checkout / "scenes");
  fs::copy(CASTRAY_ROOT "/scenes/gallery", checkout / "scenes/gallery", fs::copy_options::recursive);
  for (const char* folder : {"docs", "models"})
    fs::create_directory_symlink(fs::path(CASTRAY_ROOT) / folder, checkout / folder);
  const fs::path scenes = checkout / "scenes/gallery";
  fs::remove_all(scenes / "parts");
  REQUIRE(std::system((scenes / "make_parts").c_str()) == 0);
  int rendered = 0;
  for (const auto& entry : fs::directory_iterator(scenes)) {
    if (entry.path().extension() != ".json") continue;
    const RunResult run = run_castray(
        {"render", entry.path().string(), "--size", "24x18", "--spp", "1", "--strict", "-q", "-o", "x.pfm"},
        checkout.path());
    INFO(entry.path() << ": " << run.err);
    CHECK(run.exit_code == 0);
    ++rendered;
  }
  CHECK(rendered >= 6);
}
