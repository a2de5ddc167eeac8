#include "bench/noise_free.h"

#include <algorithm>

namespace castray {

namespace {

bool counts(const PixelMask& mask, std::size_t pixel) { return mask.empty() || mask[pixel]; }

/// The mean of term(pixel, channel) over the pixels that count and their channels.
template <class Term>
double mean_of(std::size_t pixels, const PixelMask& mask, Term term) {
  double sum = 0, number = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!counts(mask, i)) continue;
    for (int c = 0; c < 3; ++c) sum += term(i, c);
    number += 3;
  }
  return number > 0 ? sum / number : 0;
}

constexpr double square(double v) { return v * v; }
constexpr double relmse_floor = 0.01;

}  // namespace

Image ReferencePair::mean() const {
  Image result(a.width, a.height);
  for (std::size_t i = 0; i < a.pixels.size(); ++i) result.pixels[i] = (a.pixels[i] + b.pixels[i]) * 0.5f;
  return result;
}

NoiseFreeErrors noise_free_errors(const Image& x, const ReferencePair& reference, const PixelMask& mask) {
  const auto product = [&](std::size_t i, int c) {
    const double value = x.pixels[i][c];
    return (value - reference.a.pixels[i][c]) * (value - reference.b.pixels[i][c]);
  };
  const auto relative = [&](std::size_t i, int c) {
    const double r = (static_cast<double>(reference.a.pixels[i][c]) + reference.b.pixels[i][c]) / 2;
    return product(i, c) / (square(r) + relmse_floor);
  };
  const std::size_t pixels = x.pixels.size();
  return {mean_of(pixels, mask, product), mean_of(pixels, mask, relative)};
}

double reference_noise(const ReferencePair& reference, const PixelMask& mask) {
  return mean_of(reference.a.pixels.size(), mask, [&](std::size_t i, int c) {
    const double a = reference.a.pixels[i][c], b = reference.b.pixels[i][c];
    return square((a - b) / 2) / (square((a + b) / 2) + relmse_floor);
  });
}

PixelMask away_from_emitters(const Image& emission) {
  PixelMask mask(emission.pixels.size(), true);
  for (int y = 0; y < emission.height; ++y) {
    for (int x = 0; x < emission.width; ++x) {
      if (!(max_component(emission.at(x, y)) > 0)) continue;
      for (int v = std::max(0, y - 1); v <= std::min(emission.height - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(emission.width - 1, x + 1); ++u)
          mask[static_cast<std::size_t>(v) * static_cast<std::size_t>(emission.width) +
               static_cast<std::size_t>(u)] = false;
    }
  }
  return mask;
}

}  // namespace castray
