#include "plan/plan.h"

#include <catch2/catch.hpp>

#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

TEST_CASE("what a pilot measured is told with two digits, and to a hundredth near a tie") {
  RenderOptions options;
  options.width = options.height = 128;
  Plan plan = make_plan(standard_scene("cornell_box"), options, {128, 128, 0, 0, 128, 128});
  const auto told = [&](double gain) {
    choose_reconstruction(plan, gain);
    return image_source(plan, plan.reconstruct);
  };
  CHECK_THAT(told(1.0043), Catch::Contains("differences of pixels (by a pilot, differences are 1.00 times"));
  CHECK_THAT(told(0.972), Catch::Contains("means (by a pilot, differences are 0.97 times"));
  CHECK_THAT(told(1.26), Catch::Contains("differences are 1.3 times"));
  CHECK_THAT(told(0.41), Catch::Contains("differences are 0.41 times"));
  choose_reconstruction(plan, 1.3);
  CHECK(image_source(plan, false) == ", image from means");
}
