#include "image/convolve.h"

#include <algorithm>
#include <numeric>

namespace castray {

namespace {

/// The weighted sum around position `at` of a line of `length` values, `stride` apart.
float sum_at(const float* line, int at, int length, std::ptrdiff_t stride, const Taps& taps, Border border) {
  const int radius = static_cast<int>(taps.size() / 2);
  double sum = 0, inside = 0, all = 0;
  const bool cut = border == Border::cut && (at < radius || at + radius >= length);
  for (int i = -radius; i <= radius; ++i) {
    const double weight = taps[static_cast<std::size_t>(i + radius)];
    const int there = std::clamp(at + i, 0, length - 1);
    all += weight;
    if (cut && there != at + i) continue;
    inside += weight;
    sum += weight * line[there * stride];
  }
  return static_cast<float>(cut ? sum * all / inside : sum);
}

}  // namespace

Plane plane_of(const Image& image, int c) {
  Plane plane(image.width, image.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) plane.values[i] = image.pixels[i][c];
  return plane;
}

Taps make_taps(int radius, const std::function<double(int)>& f) {
  Taps taps;
  for (int i = -radius; i <= radius; ++i) taps.push_back(f(i));
  return taps;
}

Taps normalised(Taps taps) {
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  for (double& tap : taps) tap /= sum;
  return taps;
}

Plane convolve(const Plane& plane, const Taps& along_x, const Taps& along_y, Border border) {
  const int width = plane.width, height = plane.height;
  const bool worth_threads = plane.values.size() > 1 << 15;
  Plane rows(width, height), result(width, height);
#pragma omp parallel for if (worth_threads)
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      rows.at(x, y) = sum_at(&plane.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)], x,
                             width, 1, along_x, border);
#pragma omp parallel for if (worth_threads)
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      result.at(x, y) = sum_at(&rows.values[static_cast<std::size_t>(x)], y, height, width, along_y, border);
  return result;
}

}  // namespace castray
