#include "castray/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "castray/error.h"

namespace castray {

namespace {

struct Pair {
  double sum, error;
};

/// sum + error == a + b exactly (Knuth, TAOCP 2, 4.2.2).
Pair two_sum(double a, double b) {
  const double sum = a + b;
  const double from_b = sum - a;
  return {sum, (a - (sum - from_b)) + (b - from_b)};
}

void append_ranges(std::vector<SampleRange>& ranges, const std::vector<SampleRange>& more) {
  ranges.insert(ranges.end(), more.begin(), more.end());
  std::sort(ranges.begin(), ranges.end(), [](auto& a, auto& b) { return a.first < b.first; });
  std::vector<SampleRange> joined;
  for (const SampleRange& range : ranges) {
    if (!joined.empty() && range.first < joined.back().first + joined.back().count)
      throw InputError("both films hold sample " + std::to_string(range.first) +
                       "; render disjoint ranges with --samples FIRST:COUNT");
    if (!joined.empty() && range.first == joined.back().first + joined.back().count)
      joined.back().count += range.count;
    else
      joined.push_back(range);
  }
  ranges = std::move(joined);
}

}  // namespace

Film::Film(const Window& window, double brightest)
    : window_(window),
      scale_(brightest > 0 ? std::exp2(std::ceil(std::log2(brightest))) : 1.0),
      sums_(3 * static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height())),
      counts_(static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height())) {}

void Film::add(int x, int y, const Vec3f& radiance) {
  const std::size_t pixel = index(x, y);
  const double small = scale_ * 0x1p-36;
  const double rounder = scale_ * 0x1.8p-8;  // 1.5 * 2^52 quanta of 2^-60: adding it rounds to a quantum
  for (int c = 0; c < 3; ++c) {
    double v = radiance[c];
    if (std::abs(v) < small) v = (v + rounder) - rounder;
    ExactSum& s = sums_[3 * pixel + static_cast<std::size_t>(c)];
    const Pair next = two_sum(s.high, v);
    s.high = next.sum;
    s.low += next.error;
  }
  ++counts_[pixel];
}

Vec3d Film::mean(int x, int y) const {
  const std::size_t pixel = index(x, y);
  if (counts_[pixel] == 0) return {};
  const double n = counts_[pixel];
  const ExactSum* s = &sums_[3 * pixel];
  return Vec3d{s[0].high + s[0].low, s[1].high + s[1].low, s[2].high + s[2].low} / n;
}

Image Film::image() const {
  Image image(width(), height());
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x) image.at(x, y) = Vec3f(mean(window_.x0 + x, window_.y0 + y));
  return image;
}

void Film::merge(const Film& other) {
  if (window_ != other.window_) throw InputError("the films have different sizes or crop windows");
  if (key != other.key) throw InputError("the films are of different renders: " + key + " and " + other.key);
  if (scale_ != other.scale_) throw InputError("the films are of scenes of different brightness");
  append_ranges(samples, other.samples);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Pair high = two_sum(sums_[i].high, other.sums_[i].high);
    sums_[i] = {high.sum, sums_[i].low + other.sums_[i].low + high.error};
  }
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
  nonfinite_samples += other.nonfinite_samples;
}

}  // namespace castray
