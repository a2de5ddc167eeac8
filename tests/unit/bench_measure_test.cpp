#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "bench/ablation.h"
#include "bench/measure.h"
#include "bench/plot.h"
#include "castray/error.h"

using namespace castray;

namespace {

constexpr int side = 96;

Image grey() {
  Image image(side, side);
  for (Vec3f& pixel : image.pixels) pixel = {0.5f, 0.5f, 0.5f};
  return image;
}

Image noisy_grey(double sigma, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0, sigma);
  Image image = grey();
  for (Vec3f& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(pixel[c] + noise(engine));
  return image;
}

/// A renderer whose samples have a standard deviation of 0.4 and take `seconds` each.
Contender pretend(const std::string& name, ContenderKind kind, double seconds) {
  return {name, kind, "--pretend", [seconds](std::uint64_t spp, std::uint64_t seed) {
            const auto n = static_cast<double>(spp);
            return Rendering{noisy_grey(0.4 / std::sqrt(n), seed * 1000 + spp), seconds * n, seconds * n + 1};
          }};
}

BenchScene grey_scene() {
  BenchScene scene;
  scene.name = "grey <box>";
  scene.file = "grey.json";
  scene.width = scene.height = side;
  scene.reference = "made up";
  scene.reference_image = grey();
  return scene;
}

const ReferencePair& grey_reference() {
  static const ReferencePair reference{noisy_grey(0.01, 1), noisy_grey(0.01, 2)};
  return reference;
}

BenchReport measured_report() {
  BenchScene scene = grey_scene();
  const std::vector<Contender> contenders{pretend("fast", ContenderKind::configuration, 0.01),
                                          pretend("slow & \"quoted\"", ContenderKind::peer, 0.04),
                                          pretend("without", ContenderKind::ablation, 0.02)};
  measure(scene, contenders, grey_reference(), {},
          {.spp = {4, 64, 16}, .seconds = {}, .seeds = 3, .equal_seconds = {}, .crop = {}});
  BenchReport report{"1.2.3", "a machine", "castray bench", 2, 3, {}};
  report.scenes.push_back(std::move(scene));
  return report;
}

}  // namespace

TEST_CASE("a contender's error, slope and efficiency are measured as they are") {
  const BenchReport report = measured_report();
  const BenchCurve& fast = report.scenes[0].curves[0];
  const BenchCurve& slow = report.scenes[0].curves[1];
  REQUIRE(fast.points.size() == 3);
  for (const BenchPoint& point : fast.points) {
    const double n = static_cast<double>(point.spp);
    REQUIRE(point.runs.size() == 3);
    REQUIRE(point.seconds == Approx(0.01 * n));
    REQUIRE(*point.process_seconds == Approx(0.01 * n + 1));
    REQUIRE(point.mse == Approx(0.16 / n).epsilon(0.05));  // 27648 values: 0.85 % is one standard error
    REQUIRE(point.relmse == Approx(0.16 / n / 0.26).epsilon(0.05));
  }
  REQUIRE(fast.fit->slope == Approx(1).epsilon(0.02));
  REQUIRE(fast.points[2].efficiency / slow.points[2].efficiency == Approx(4).epsilon(0.05));
  REQUIRE(*fast.fit->seconds_to(1e-3) == Approx(0.16 / 0.26 * 0.01 / 1e-3).epsilon(0.1));
}

TEST_CASE("a report says where its references are too noisy for the errors that it tells") {
  BenchReport report = measured_report();  // the least relMSE is 0.01
  const auto warns = [&report](double noise) {
    report.scenes[0].reference_noise = noise;
    return bench_table(report).find("references' noise") != std::string::npos;
  };
  REQUIRE(warns(0.1));
  REQUIRE_FALSE(warns(0.02));
}

TEST_CASE("at equal time each contender renders with the spp that fit") {
  const BenchScene scene = measured_report().scenes[0];
  REQUIRE(scene.equal_seconds == Approx(0.16));  // the slow one's 4 spp
  REQUIRE(scene.curves[0].equal_time->spp == 16);
  REQUIRE(scene.curves[1].equal_time->spp == 4);
  REQUIRE_FALSE(scene.curves[2].equal_time);  // ablations are not shown as pictures
  REQUIRE(scene.curves[0].equal_time->flip < scene.curves[1].equal_time->flip);
  REQUIRE(scene.crop.width() == 32);
}

TEST_CASE("budgets in seconds become samples by the first render") {
  BenchScene scene = grey_scene();
  const BenchPlan plan{.spp = {}, .seconds = {0.1, 1}, .seeds = 1, .equal_seconds = 0.5, .crop = {}};
  measure(scene, {pretend("one", ContenderKind::configuration, 0.01)}, grey_reference(), {}, plan);
  REQUIRE(scene.curves[0].points.size() == 2);
  REQUIRE(scene.curves[0].points[0].spp == 10);
  REQUIRE(scene.curves[0].points[1].spp == 100);
  REQUIRE(scene.curves[0].equal_time->spp == 50);
}

TEST_CASE("an ablation says what leaving a technique out costs") {
  const std::vector<AblationRow> rows = ablation_rows(measured_report().scenes[0]);
  REQUIRE(rows.size() == 1);
  REQUIRE(rows[0].seconds == Approx(2));
  REQUIRE(rows[0].relmse == Approx(1).epsilon(0.05));
  REQUIRE(rows[0].efficiency == Approx(0.5).epsilon(0.05));
}

TEST_CASE("an ablation that the scene does not allow is told, any other failure stops the benchmark") {
  const auto refuse = [](std::uint64_t, std::uint64_t) -> Rendering {
    throw InputError("no such thing here");
  };
  BenchScene scene = grey_scene();
  const BenchPlan plan{.spp = {4}, .seconds = {}, .seeds = 1, .equal_seconds = {}, .crop = {}};
  measure(scene,
          {pretend("all", ContenderKind::configuration, 0.01), {"off", ContenderKind::ablation, "", refuse}},
          grey_reference(), {}, plan);
  REQUIRE(scene.curves[1].points.empty());
  REQUIRE(scene.curves[1].failure == "no such thing here");
  BenchScene other = grey_scene();
  REQUIRE_THROWS_AS(measure(other, {{"peer", ContenderKind::peer, "", refuse}}, grey_reference(), {}, plan),
                    InputError);
}

TEST_CASE("an image of another size is refused with the name of who made it") {
  BenchScene scene = grey_scene();
  scene.width = 100;
  const BenchPlan plan{.spp = {4}, .seconds = {}, .seeds = 1, .equal_seconds = {}, .crop = {}};
  REQUIRE_THROWS_WITH(
      measure(scene, {pretend("fast", ContenderKind::peer, 0.01)}, grey_reference(), {}, plan),
      Catch::Contains("fast") && Catch::Contains("96x96"));
}

TEST_CASE("progress goes from 0 to 1 and counts the seconds down") {
  BenchScene scene = grey_scene();
  std::vector<BenchProgress> told;
  measure(scene, {pretend("one", ContenderKind::configuration, 0.01)}, grey_reference(), {},
          {.spp = {4, 16}, .seconds = {}, .seeds = 4, .equal_seconds = {}, .crop = {}},
          [&](const BenchProgress& progress) { told.push_back(progress); });
  REQUIRE(told.size() == 1 + 2 * 4 + 1);
  for (std::size_t i = 2; i < told.size(); ++i) {
    REQUIRE(told[i].fraction >= told[i - 1].fraction);
    REQUIRE(told[i].seconds_left <= told[i - 1].seconds_left);
    REQUIRE(told[i].fraction <= 1);
  }
}

TEST_CASE("the JSON report has every number, and the page and the plot show every contender") {
  const BenchReport report = measured_report();
  const auto json = nlohmann::json::parse(bench_json(report));
  const auto& curve = json["scenes"][0]["curves"][1];
  REQUIRE(curve["name"] == "slow & \"quoted\"");
  REQUIRE(curve["kind"] == "peer");
  REQUIRE(curve["points"][2]["spp"] == 64);
  REQUIRE(curve["points"][2]["runs"].size() == 3);
  REQUIRE(curve["seconds_to"]["1e-03"].is_number());
  REQUIRE(json["scenes"][0]["ablation"][0]["efficiency_ratio"].is_number());

  const std::string html = bench_html(report);
  REQUIRE_THAT(html, Catch::Contains("slow &amp; &quot;quoted&quot;") && Catch::Contains("grey &lt;box&gt;"));
  REQUIRE_THAT(html, Catch::Contains("data:image/png;base64,iVBORw0KGgo"));
  REQUIRE_THAT(html, !Catch::Contains("http") && !Catch::Contains("nan") && !Catch::Contains("inf"));
  const std::string svg = bench_svg(report);
  REQUIRE(svg.starts_with("<svg"));
  REQUIRE_THAT(svg, Catch::Contains("slow &amp; &quot;quoted&quot;") && !Catch::Contains("nan"));

  const std::string csv = bench_csv(report);
  REQUIRE(std::count(csv.begin(), csv.end(), '\n') == 1 + 3 * 3);
  REQUIRE_THAT(csv, Catch::Contains("grey <box>,\"slow & \"\"quoted\"\"\",peer,4,0.16,1.16,"));
  REQUIRE_THAT(bench_table(report), Catch::Contains("fast") && Catch::Contains("without"));
}

TEST_CASE("points without time or error do not break a plot") {
  const std::string plot =
      log_log_plot("t", {{"a", {{0.1, 1e-3}, {0.2, -1e-9}}, std::nullopt}, {"b", {}, std::nullopt}});
  REQUIRE_THAT(plot, Catch::Contains(">a</text>") || Catch::Contains("series-0"));
  REQUIRE_THAT(plot, !Catch::Contains("nan") && !Catch::Contains("inf"));
}
