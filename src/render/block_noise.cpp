#include "render/block_noise.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace castray {

namespace {

/// A block's noise is taken to be at least this part of the image's: a short pilot may have missed rare
/// paths. So each block gets at least an eighth of the samples that the image's mean noise asks for.
constexpr double least_noise = 1.0 / 64;
/// What the fall of the noise is found from: films of at least so many times the samples, unless one is part
/// of the other. So much of it may be chance.
constexpr double least_growth = 3, chance_of_fall = 0.1;

/// The radiance of each pixel of a film's image.
class Radiance {
 public:
  explicit Radiance(const Film& film, int threads = 0) : film_(film) {
    if (film.differences().kept()) reconstructed_ = image_of(film, threads);
  }
  const Window& window() const { return film_.window(); }
  /// Pixel (x,y) of the full image.
  double at(int x, int y, int c) const {
    return reconstructed_ ? double{reconstructed_->at(x - window().x0, y - window().y0)[c]}
                          : film_.mean(x, y)[c];
  }

 private:
  const Film& film_;
  std::optional<Image> reconstructed_;
};

/// f(a, b) of every pixel's radiance in channel c.
template <class F>
Plane plane_of(const Radiance& a, const Radiance& b, int c, F f) {
  const Window& w = a.window();
  Plane plane(w.width(), w.height());
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x)
      plane.at(x - w.x0, y - w.y0) = static_cast<float>(f(a.at(x, y, c), b.at(x, y, c)));
  return plane;
}

/// The means of squares of 2 radius + 1 pixels.
Plane means_around(const Plane& plane, int radius) {
  const Taps taps = normalised(make_taps(radius, [](int) { return 1.; }));
  return convolve(plane, taps, taps, Border::cut);
}

/// The squared radiance that a channel's error is held to, from products a b, whose noise is 0 on average.
/// Where noise exceeds the signal, a pixel's own product may be near 0: it is drawn to the mean around it
/// (Efron and Morris 1973). An outlier raises its own product, but the mean of 25 less: it is at most that.
Plane squared_radiance(const Radiance& a, const Radiance& b, int c) {
  const Plane own = plane_of(a, b, c, [](double p, double q) { return std::max(p * q, 0.); });
  const Plane noise =
      means_around(plane_of(a, b, c, [](double p, double q) { return (p - q) * (p - q) / 2; }), 1);
  const Plane near = means_around(own, 1);
  Plane squares = means_around(own, 2);
  for (std::size_t i = 0; i < own.values.size(); ++i) {
    const float s = near.values[i], v = noise.values[i];
    if (s + v > 0) squares.values[i] = std::min(squares.values[i], s * (v + own.values[i]) / (s + v));
  }
  return squares;
}

/// From mean noise `before` to `after`, in films of `growth` times the samples.
double fall_of(double before, double after, double growth) {
  return std::clamp(std::log(before / after) / std::log(growth) - chance_of_fall, 0., 0.5);
}

double area(const Window& w) { return static_cast<double>(w.width()) * w.height(); }

}  // namespace

PixelNoise::PixelNoise(const Film& a, const Film& b, int threads)
    : window_(a.window()), plane_(a.width(), a.height()) {
  const Radiance of_a(a, threads), of_b(b, threads);
  for (int c = 0; c < 3; ++c) {
    const Plane squares = squared_radiance(of_a, of_b, c);
    for (int y = window_.y0; y < window_.y1; ++y)
      for (int x = window_.x0; x < window_.x1; ++x) {
        const double n = a.count(x, y), m = b.count(x, y);
        if (n == 0 || m == 0) continue;
        const double difference = of_a.at(x, y, c) - of_b.at(x, y, c);  // variance: (1/n + 1/m) of a sample's
        const double square = squares.at(x - window_.x0, y - window_.y0);
        plane_.at(x - window_.x0, y - window_.y0) +=
            static_cast<float>(difference * difference / (square + 0.01) / 3 / (1 / n + 1 / m));
      }
  }
}

double PixelNoise::expected_error(const Film& film) const {
  double sum = 0;
  for (int y = window_.y0; y < window_.y1; ++y)
    for (int x = window_.x0; x < window_.x1; ++x)
      sum += film.count(x, y) > 0 ? at(x, y) / film.count(x, y) : 1;  // black: the error is r^2
  return sum / area(window_);
}

double fall_from_first(const Film& a, const Film& b, const Film& first_a, const Film& first_b) {
  const Window& w = a.window();
  double of_one = 0, of_two = 0;
  for (int c = 0; c < 3; ++c) {
    const Plane squares = squared_radiance(Radiance(a), Radiance(b), c);
    for (int y = w.y0; y < w.y1; ++y)
      for (int x = w.x0; x < w.x1; ++x) {
        if (a.count(x, y) != 2 || b.count(x, y) != 2) continue;
        const double both = a.mean(x, y)[c] - b.mean(x, y)[c];
        const double first = first_a.mean(x, y)[c] - first_b.mean(x, y)[c], second = 2 * both - first;
        const double share = 1 / (squares.at(x - w.x0, y - w.y0) + 0.01);
        of_one += (first * first + second * second) / 4 * share;
        of_two += both * both * share;
      }
  }
  return of_two > 0 ? fall_of(of_one, of_two, 2) : 0;
}

BlockNoise::BlockNoise(const PixelNoise& pixels, const SampleMap& blocks) : blocks_(blocks) {
  for (std::size_t i = 0; i < blocks.blocks(); ++i) {
    const Window w = blocks.block(i);
    double sum = 0;
    for (int y = w.y0; y < w.y1; ++y)
      for (int x = w.x0; x < w.x1; ++x) sum += pixels.at(x, y);
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

double BlockNoise::fall_from(const BlockNoise& shorter) const {
  const double growth = static_cast<double>(blocks_.total()) / static_cast<double>(shorter.blocks_.total());
  if (growth < least_growth) return shorter.fall_;
  const double before = shorter.mean([&](std::size_t i) { return shorter.noise_[i]; });
  const double after = mean([&](std::size_t i) { return noise_[i]; });
  return fall_of(before, after, growth);
}

double BlockNoise::expected_error(const SampleMap& map) const {
  return mean([&](std::size_t i) {
    const double samples = static_cast<double>(map.count(i));
    return noise_[i] / samples * std::pow(2 * static_cast<double>(blocks_.count(i)) / samples, fall_);
  });
}

SampleMap BlockNoise::planned(double samples_per_noise, std::uint64_t least, std::uint64_t most) const {
  std::vector<std::uint64_t> counts;
  for (const double noise : noise_) {
    const double count = std::ceil(samples_per_noise * std::sqrt(noise));
    counts.push_back(count < static_cast<double>(most)
                         ? std::max(std::min(least, most), static_cast<std::uint64_t>(count))
                         : most);
  }
  SampleMap map = blocks_;
  map.set_first(0);
  map.set_counts(std::move(counts));
  return map;
}

SampleMap BlockNoise::plan(double target, std::uint64_t least, std::uint64_t most) const {
  const double calmest = *std::min_element(noise_.begin(), noise_.end());
  if (!(calmest > 0)) return planned(0, least, most);  // then nothing is noisy
  double low = 0, high = static_cast<double>(most) / std::sqrt(calmest);
  if (expected_error(planned(high, least, most)) > target) return planned(high, least, most);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (expected_error(planned(middle, least, most)) > target ? low : high) = middle;
  }
  return planned(high, least, most);
}

}  // namespace castray
