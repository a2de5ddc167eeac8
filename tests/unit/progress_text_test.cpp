#include "cli/progress_text.h"

#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>
#include <utility>

#include "core/text.h"

using namespace castray::cli;
using Catch::Contains;

TEST_CASE("the bar never wraps, and says as much as there is room for") {
  const ProgressState state{0.4567, 3725, 4321, 12.3e6};
  for (int columns = 1; columns < 200; ++columns) {
    CAPTURE(columns);
    const std::string text = bar_text(state, columns);
    CHECK(static_cast<int>(text.size()) < columns);
    if (columns > 8) CHECK_THAT(text, Contains("45.7 %"));
    if (columns > 30) CHECK_THAT(text, Contains("1:12:01 left"));
    if (columns > 100) CHECK_THAT(text, Contains("1:02:05 elapsed") && Contains("12.30 Msamples/s"));
    CHECK(static_cast<int>(shortened(text + text, columns).size()) < columns);
  }
  CHECK_THAT(bar_text({1, 5, 0, 1}, 80), Contains("[########################] 100.0 %"));
  CHECK_THAT(bar_text({0, 5, std::nullopt, 1}, 80),
             Contains("[........................]   0.0 %") && Contains("? left"));
}

TEST_CASE("numbers in sentences have two digits and no exponent") {
  const std::pair<double, const char*> cases[] = {{0.0234, "0.023"},
                                                  {4.46, "4.5"},
                                                  {99.4, "99"},
                                                  {99.6, "100"},
                                                  {232, "230"},
                                                  {960, "960"},
                                                  {996, "1000"},
                                                  {12345, "12000"},
                                                  {994e3, "990000"},
                                                  {3.1e6, "more than a million"},
                                                  {1e300, "more than a million"}};
  for (const auto& [value, text] : cases) CHECK(castray::two_digits(value) == text);
}

TEST_CASE("progress for programs is one JSON object a line") {
  const auto object = nlohmann::json::parse(json_text({0.25, 1.5, 4.5, 1e6}));
  CHECK(object["phase"] == "rendering");
  CHECK(object["fraction"] == 0.25);
  CHECK(object["elapsed_seconds"] == 1.5);
  CHECK(object["seconds_left"] == 4.5);
  CHECK(object["samples_per_second"] == 1e6);
  CHECK_FALSE(nlohmann::json::parse(json_text({0, 1, std::nullopt, 0})).contains("seconds_left"));
  CHECK(nlohmann::json::parse(json_text("reading \"a\".obj", 2))["phase"] == "reading \"a\".obj");
}
