#include <algorithm>
#include <array>

#include "image/blocks.h"

namespace castray {

namespace {

/// The noise of some blocks, per channel.
std::array<Estimate, 3> estimates_of(const Film& film, const Film::Blocks& blocks) {
  const std::vector<Vec3d> means = film.replicate_means(blocks);
  return {estimate(channel_of(means, 0)), estimate(channel_of(means, 1)), estimate(channel_of(means, 2))};
}

/// The pixels of the film in some blocks, as an image's rectangle.
struct Rectangle {
  int x0, y0, x1, y1;
  double pixels() const { return double(x1 - x0) * (y1 - y0); }
};

Rectangle pixels_of(const Film& film, const Film::Blocks& blocks) {
  const Window& w = film.window();
  return {std::max(blocks.x0 * noise_block, w.x0) - w.x0, std::max(blocks.y0 * noise_block, w.y0) - w.y0,
          std::min(blocks.x1 * noise_block, w.x1) - w.x0, std::min(blocks.y1 * noise_block, w.y1) - w.y0};
}

/// Every pixel of a block has the block's variance times its pixels: as if they were independent.
Image variance_of_blocks(const Film& film) {
  Image variance(film.width(), film.height());
  for (const Film::Blocks& block : groups_of(film.blocks(), 1)) {
    const std::array<Estimate, 3> noise = estimates_of(film, block);
    const Rectangle r = pixels_of(film, block);
    const Vec3f each(Vec3d{noise[0].variance, noise[1].variance, noise[2].variance} * r.pixels());
    for (int y = r.y0; y < r.y1; ++y)
      std::fill(&variance.at(r.x0, y), &variance.at(r.x0, y) + (r.x1 - r.x0), each);
  }
  return variance;
}

/// The mean, over the groups of size x size blocks, of a group's variance in units of what it would be if its
/// blocks were independent.
double correlation(const Film& film, const Image& variance, int size) {
  double sum = 0;
  int count = 0;
  for (const Film::Blocks& group : groups_of(film.blocks(), size)) {
    const std::array<Estimate, 3> noise = estimates_of(film, group);
    const Rectangle r = pixels_of(film, group);
    Vec3d independent;
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) independent += Vec3d(variance.at(x, y));
    for (int c = 0; c < 3; ++c)
      if (independent[c] > 0)
        sum += noise[static_cast<std::size_t>(c)].variance * r.pixels() * r.pixels() / independent[c],
            ++count;
  }
  return count ? sum / count : 1;
}

}  // namespace

std::optional<Noise> noise_of(const Film& film) {
  const std::size_t replicates = film.replicate_means({}).size();
  if (replicates < 2) return std::nullopt;
  Noise noise{variance_of_blocks(film), static_cast<double>(replicates - 1)};
  double factor = 1;
  for (int size = 1; size < count_sizes(film.blocks()); ++size)
    factor = std::max(factor, correlation(film, noise.variance, 1 << size));
  for (Vec3f& v : noise.variance.pixels) v *= static_cast<float>(factor);
  return noise;
}

}  // namespace castray
