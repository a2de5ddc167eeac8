#include "castray/metrics.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "test_image.h"

using namespace castray;

TEST_CASE("metrics agree with numpy, scikit-image and flip-evaluator on generated pairs") {
  const std::filesystem::path folder = CASTRAY_ROOT "/tests/golden/metrics";
  const auto expected = nlohmann::json::parse(read_file(folder / "expected.json"));
  REQUIRE(expected.size() == 10);
  for (const auto& [name, values] : expected.items()) {
    INFO(name);
    const Image image = read_image(folder / (name + "_image.pfm")).image;
    const Image reference = read_image(folder / (name + "_reference.pfm")).image;
    const ErrorMetrics m = measure_errors(image, reference, greatest_component(reference));
    const auto close = [&, v = values](const char* metric, double value) {
      INFO(metric);
      CHECK(value == Approx(v[metric].get<double>()).epsilon(1e-9).margin(1e-300));
    };
    close("mse", m.mse), close("rmse", m.rmse), close("relmse", m.relmse), close("mae", m.mae);
    close("max_error", m.max_error);
    close("percent_beyond_0.05", percent_beyond(image, reference, 0.05));
    for (int c = 0; c < 3; ++c)
      CHECK(m.bias[c] == Approx(values["bias_rgb"][static_cast<std::size_t>(c)].get<double>()).margin(1e-15));
    if (values["psnr"].is_null())
      CHECK(std::isinf(m.psnr));
    else
      CHECK(m.psnr == Approx(values["psnr"].get<double>()).margin(1e-4));
    CHECK(ssim(displayed(image, {}), displayed(reference, {})) ==
          Approx(values["ssim"].get<double>()).epsilon(0).margin(1e-4));
    CHECK(flip(displayed(image, {}), displayed(reference, {})) ==
          Approx(values["flip"].get<double>()).epsilon(0).margin(1e-3));
    if (!values["flip_hdr"].is_null())
      CHECK(flip_hdr(image, reference) == Approx(values["flip_hdr"].get<double>()).epsilon(0).margin(1e-3));
  }
}

TEST_CASE("the heat map shows errors on its fixed scale") {
  Image reference(200, 3), image(200, 3);
  for (int x = 0; x < 200; ++x) image.at(x, 1) = Vec3f(1e-5f * std::exp2(static_cast<float>(x) / 20));
  const Image map = heat_map(image, reference);
  CHECK(map.width == 200);
  CHECK(map.at(5, 0) == Vec3f(0, 0, 0));
  CHECK(map.at(5, 1) == Vec3f(0, 0, 0));
  for (int x = 80; x < 199; ++x) CHECK(luminance(map.at(x, 1)) < luminance(map.at(x + 1, 1)));
  for (int x = 0; x < 199; ++x) CHECK(luminance(map.at(x, 6)) < luminance(map.at(x + 1, 6)));
}
