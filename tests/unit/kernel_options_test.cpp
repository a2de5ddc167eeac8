#include "wavefront/kernel_options.h"

#include <catch2/catch.hpp>

using namespace castray;

TEST_CASE("tiles stay ragged where a single sample may show as a square") {
  Plan plan;
  plan.suffixes = 64;
  plan.few_suffixes = 32;
  plan.light_paths = true;
  const auto ragged = [&](bool differences) { return kernel_options({}, plan, differences).ragged; };
  CHECK(ragged(false) == 4);
  CHECK(ragged(true) == 2);  // of each half
  plan.suffixes = 32;
  CHECK(ragged(false) > 1'000'000'000);
  CHECK(ragged(true) == 2);
  plan.light_paths = false;
  CHECK(ragged(false) == 4);
  plan.suffixes = 0;
  CHECK(ragged(false) == 0);
}
