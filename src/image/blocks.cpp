#include "image/blocks.h"

#include <algorithm>

namespace castray {

std::vector<Film::Blocks> groups_of(const Film::Blocks& all, int size) {
  std::vector<Film::Blocks> groups;
  for (int y = all.y0 / size * size; y < all.y1; y += size)
    for (int x = all.x0 / size * size; x < all.x1; x += size)
      groups.push_back(
          {std::max(x, all.x0), std::max(y, all.y0), std::min(x + size, all.x1), std::min(y + size, all.y1)});
  return groups;
}

int count_sizes(const Film::Blocks& all) {
  int sizes = 1;
  while (groups_of(all, 1 << (sizes - 1)).size() > 1) ++sizes;
  return sizes;
}

Estimate estimate(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Estimate e;
  for (const double v : values) e.mean += v / n;
  for (const double v : values) e.variance += (v - e.mean) * (v - e.mean) / ((n - 1) * n);
  e.freedom = n - 1;
  return e;
}

std::vector<double> channel_of(const std::vector<Vec3d>& means, int channel) {
  std::vector<double> values;
  for (const Vec3d& mean : means) values.push_back(mean[channel]);
  return values;
}

}  // namespace castray
