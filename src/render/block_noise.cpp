#include "render/block_noise.h"

#include <algorithm>
#include <cmath>

namespace castray {

namespace {

/// A block's noise is taken to be at least this part of the image's: a short pilot may have missed rare
/// paths. So each block gets at least an eighth of the samples that the image's mean noise asks for.
constexpr double least_noise = 1.0 / 64;

/// relMSE of one sample of a pixel, from means `a` of n and `b` of m samples.
double pixel_noise(const Vec3d& a, double n, const Vec3d& b, double m) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double difference = a[c] - b[c];            // of variance (1/n + 1/m) times a sample's
    const double square = std::max(a[c] * b[c], 0.);  // of the radiance, free of noise on average
    sum += difference * difference / (square + 0.01);
  }
  return sum / 3 / (1 / n + 1 / m);
}

double area(const Window& w) { return static_cast<double>(w.width()) * w.height(); }

}  // namespace

BlockNoise::BlockNoise(const Film& a, const Film& b, const SampleMap& blocks) : blocks_(blocks) {
  for (std::size_t i = 0; i < blocks.blocks(); ++i) {
    const Window w = blocks.block(i);
    double sum = 0;
    for (int y = w.y0; y < w.y1; ++y)
      for (int x = w.x0; x < w.x1; ++x)
        if (a.count(x, y) > 0 && b.count(x, y) > 0)
          sum += pixel_noise(a.mean(x, y), a.count(x, y), b.mean(x, y), b.count(x, y));
    noise_.push_back(sum / area(w));
  }
  raise_the_least();
}

template <class Value>
double BlockNoise::mean(Value value) const {
  double sum = 0, pixels = 0;
  for (std::size_t i = 0; i < noise_.size(); ++i) {
    sum += value(i) * area(blocks_.block(i));
    pixels += area(blocks_.block(i));
  }
  return sum / pixels;
}

void BlockNoise::raise_the_least() {
  const double least = least_noise * mean([&](std::size_t i) { return noise_[i]; });
  for (double& noise : noise_) noise = std::max(noise, least);
}

double BlockNoise::expected_error(const SampleMap& map) const {
  return mean([&](std::size_t i) { return noise_[i] / static_cast<double>(map.count(i)); });
}

double BlockNoise::expected_error(const Film& film) const {
  double sum = 0;
  for (std::size_t i = 0; i < noise_.size(); ++i) {
    const Window w = blocks_.block(i);
    for (int y = w.y0; y < w.y1; ++y)
      for (int x = w.x0; x < w.x1; ++x)
        sum += film.count(x, y) > 0 ? noise_[i] / film.count(x, y) : 1;  // black: the error is r^2
  }
  return sum / area(film.window());
}

SampleMap BlockNoise::planned(double samples_per_noise, std::uint64_t most) const {
  std::vector<std::uint64_t> counts;
  for (const double noise : noise_) {
    const double count = std::ceil(samples_per_noise * std::sqrt(noise));
    counts.push_back(count < static_cast<double>(most) ? std::max<std::uint64_t>(1, std::uint64_t(count))
                                                       : most);
  }
  SampleMap map = blocks_;
  map.set_first(0);
  map.set_counts(std::move(counts));
  return map;
}

SampleMap BlockNoise::plan(double target, std::uint64_t most) const {
  const double least = *std::min_element(noise_.begin(), noise_.end());
  if (!(least > 0)) return planned(0, most);  // then nothing is noisy
  double low = 0, high = static_cast<double>(most) / std::sqrt(least);
  if (expected_error(planned(high, most)) > target) return planned(high, most);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (expected_error(planned(middle, most)) > target ? low : high) = middle;
  }
  return planned(high, most);
}

}  // namespace castray
