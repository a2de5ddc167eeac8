#include "image/convolve.h"

#include <algorithm>
#include <numeric>

namespace castray {

namespace {

Plane transposed(const Plane& plane) {
  Plane result(plane.height, plane.width);
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) result.at(y, x) = plane.at(x, y);
  return result;
}

/// Along columns: whole rows are added up, which compilers turn into vector instructions.
Plane convolve_columns(const Plane& plane, const Taps& taps, Border border) {
  const int radius = static_cast<int>(taps.size() / 2);
  const auto width = static_cast<std::size_t>(plane.width);
  const double all = std::accumulate(taps.begin(), taps.end(), 0.0);
  Plane result(plane.width, plane.height);
  std::vector<double> sums(width);
  for (int y = 0; y < plane.height; ++y) {
    std::fill(sums.begin(), sums.end(), 0.0);
    double used = 0;
    for (int i = -radius; i <= radius; ++i) {
      const int there = std::clamp(y + i, 0, plane.height - 1);
      if (border == Border::cut && there != y + i) continue;
      const double weight = taps[static_cast<std::size_t>(i + radius)];
      const float* row = &plane.values[static_cast<std::size_t>(there) * width];
      used += weight;
      for (std::size_t x = 0; x < width; ++x) sums[x] += weight * row[x];
    }
    const double scale = border == Border::cut ? all / used : 1;
    for (std::size_t x = 0; x < width; ++x)
      result.at(static_cast<int>(x), y) = static_cast<float>(scale * sums[x]);
  }
  return result;
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
  const Plane rows = convolve_columns(transposed(plane), along_x, border);
  return convolve_columns(transposed(rows), along_y, border);
}

}  // namespace castray
