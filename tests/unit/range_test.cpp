#include "core/range.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace castray;

TEST_CASE("ranges say what they contain") {
  CHECK(unit_range.text() == "at least 0 and at most 1");
  CHECK(index_range.text() == "greater than 0 and at most 10000");
  CHECK(fov_range.text() == "at least 1e-05 and less than 180");
  CHECK(radiance_range.text() == "0, or at least 1e-30 and at most 1e+30");
  CHECK(not_negative.text() == "at least 0");
  CHECK(Range{}.text() == "finite");
}

TEST_CASE("radiance is 0 or what floats hold with room on both sides") {
  for (const double inside : {0.0, 1e-30, 1.0, 1e30}) CHECK(radiance_range.contains(inside));
  for (const double outside : {-1.0, 1e-31, 1e-320, 1.1e30, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()})
    CHECK_FALSE(radiance_range.contains(outside));
  CHECK_FALSE(index_range.contains(0));
  CHECK_FALSE(fov_range.contains(180));
}
