#include "castray/metrics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "castray/error.h"

namespace castray {

namespace {

void require_finite(const Image& image, const char* which) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (const Vec3f& v = image.at(x, y); !is_finite(v))
        throw InputError(
            fmt::format("pixel ({},{}) of the {} is not finite: ({}, {}, {})", x, y, which, v.x, v.y, v.z));
}

}  // namespace

std::vector<std::pair<std::string, double>> ErrorMetrics::named() const {
  const double greatest_bias = std::max({std::abs(bias.x), std::abs(bias.y), std::abs(bias.z)});
  return {{"mse", mse},   {"rmse", rmse},           {"relmse", relmse},     {"mae", mae},
          {"psnr", psnr}, {"max_error", max_error}, {"bias", greatest_bias}};
}

double greatest_component(const Image& image) {
  float greatest = 0;
  for (const Vec3f& v : image.pixels) greatest = std::max(greatest, max_component(v));
  return greatest > 0 ? greatest : 1;
}

double percent_beyond(const Image& image, const Image& reference, double bound) {
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Vec3d difference = Vec3d(image.pixels[i]) - Vec3d(reference.pixels[i]);
    beyond += std::max({std::abs(difference.x), std::abs(difference.y), std::abs(difference.z)}) > bound;
  }
  return 100 * static_cast<double>(beyond) / static_cast<double>(image.pixels.size());
}

ErrorMetrics measure_errors(const Image& image, const Image& reference, double peak) {
  if (image.width != reference.width || image.height != reference.height)
    throw InputError(fmt::format("the sizes differ: the image is {}x{}, the reference {}x{}", image.width,
                                 image.height, reference.width, reference.height));
  require_finite(image, "image");
  require_finite(reference, "reference");
  ErrorMetrics m;
  m.peak = peak;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec3d r(reference.at(x, y)), difference = Vec3d(image.at(x, y)) - r;
      m.bias += difference;
      for (int c = 0; c < 3; ++c) {
        const double error = std::abs(difference[c]);
        m.mse += error * error;
        m.relmse += error * error / (r[c] * r[c] + 0.01);
        m.mae += error;
        if (error > m.max_error) m.max_error = error, m.max_x = x, m.max_y = y;
      }
    }
  const auto pixels = static_cast<double>(image.pixels.size());
  m.mse /= 3 * pixels;
  m.relmse /= 3 * pixels;
  m.mae /= 3 * pixels;
  m.bias = m.bias / pixels;
  m.rmse = std::sqrt(m.mse);
  m.psnr = 10 * std::log10(peak * peak / m.mse);
  return m;
}

}  // namespace castray
