#include "core/sequences.h"

#include <catch2/catch.hpp>

#include "castray/render.h"
#include "reference_images.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Independence and convergence of the random numbers.

namespace {

constexpr std::uint32_t blocks = 6;

/// One number of many: dimension of a block at a pixel, x to the right of where it is asked for.
struct Draw {
  int x;
  std::uint32_t block;
  std::size_t dimension;

  double at(SamplerKind kind, int pixel_x, int y, std::uint64_t sample) const {
    return static_cast<double>(sample_block(kind, pixel_key(pixel_x + x, y, 3), sample, block)[dimension]);
  }
};

/// Pairs of numbers that must know nothing of each other: of different blocks, or of neighbouring pixels.
std::vector<std::pair<Draw, Draw>> unrelated_pairs() {
  std::vector<std::pair<Draw, Draw>> pairs;
  for (std::uint32_t a = 0; a < blocks; ++a)
    for (std::uint32_t b = a; b < blocks; ++b)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
          if (a != b) pairs.push_back({{0, a, i}, {0, b, j}});
          pairs.push_back({{0, a, i}, {1, b, j}});
        }
  return pairs;
}

/// Variance of the mean of n numbers f(u) over scrambles.
template <class F>
double variance_of_mean(SamplerKind kind, std::uint64_t n, const F& f) {
  Mean means;
  for (std::uint32_t key = 0; key < 200; ++key) {
    double sum = 0;
    for (std::uint64_t i = 0; i < n; ++i) sum += f(sample_block(kind, hash32(key), i, 0));
    means.add(sum / static_cast<double>(n));
  }
  return means.variance();
}

/// Slope of log y over log x, by least squares.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  Mean mx, my;
  for (const double v : x) mx.add(std::log(v));
  for (const double v : y) my.add(std::log(v));
  double xy = 0, xx = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (std::log(x[i]) - mx.mean()) * (std::log(y[i]) - my.mean());
    xx += (std::log(x[i]) - mx.mean()) * (std::log(x[i]) - mx.mean());
  }
  return xy / xx;
}

}  // namespace

// One sample of each of 2^14 pixels, so that all pairs are independent draws: Pearson's test on 8x8 cells.
TEST_CASE("numbers of different blocks and of neighbouring pixels fill their square evenly",
          "[statistical]") {
  const auto pairs = unrelated_pairs();
  constexpr int side = 128, cells = 8;
  for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent}) {
    double least = 1;
    for (const auto& [a, b] : pairs) {
      std::vector<double> counts(cells * cells);
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < 2 * side; x += 2)  // no pixel twice
          ++counts[static_cast<std::size_t>(a.at(kind, x, y, 11) * cells) * cells +
                   static_cast<std::size_t>(b.at(kind, x, y, 11) * cells)];
      const std::vector<double> expected(cells * cells, double(side) * side / (cells * cells));
      least = std::min(least, chi_square_probability(counts, expected));
    }
    CAPTURE(static_cast<int>(kind), least, pairs.size());
    CHECK(least * static_cast<double>(pairs.size()) > 1e-4);  // the rate of false alarms
  }
}

// Samples of one pixel are not independent of each other, so correlations are averaged over pixels.
TEST_CASE("blocks and neighbouring pixels are uncorrelated over the samples of a pixel", "[statistical]") {
  const auto pairs = unrelated_pairs();
  double largest = 0, squares = 0;
  for (const auto& [a, b] : pairs) {
    Mean correlation;
    for (int x = 0; x < 400; x += 2) {
      double sum = 0;
      for (std::uint64_t i = 0; i < 32; ++i)
        sum += (a.at(SamplerKind::sobol, x, 5, i) - 0.5) * (b.at(SamplerKind::sobol, x, 5, i) - 0.5);
      correlation.add(sum);
    }
    const double z = correlation.mean() / correlation.error();
    largest = std::max(largest, std::abs(z));
    squares += z * z;
  }
  CAPTURE(largest, pairs.size());
  CHECK(largest < score_limit(pairs.size(), 1e-4));
  CHECK(std::sqrt(squares / static_cast<double>(pairs.size())) < 1.15);  // 1 has a standard error below 0.04
}

TEST_CASE("the error of a smooth pixel falls faster than 1/N with the sequence, as 1/N without",
          "[statistical]") {
  // what a point of a unit square gets from a parallel one at distance 1
  const auto irradiance = [](const std::array<float, 4>& u) {
    const double dx = u[0] - u[2], dy = u[1] - u[3];
    return 1 / ((1 + dx * dx + dy * dy) * (1 + dx * dx + dy * dy));
  };
  std::vector<double> n;
  for (int m = 4; m <= 12; ++m) n.push_back(std::exp2(m));
  const auto slope_of = [&](SamplerKind kind) {
    std::vector<double> variances;
    for (const double count : n)
      variances.push_back(variance_of_mean(kind, static_cast<std::uint64_t>(count), irradiance));
    return slope(n, variances);
  };
  const double sobol = slope_of(SamplerKind::sobol), independent = slope_of(SamplerKind::independent);
  CAPTURE(sobol, independent);
  CHECK(sobol < -1.3);
  CHECK(independent == Approx(-1).margin(0.1));  // of 9 variances, each known to 10 %: 0.02 and some
}

TEST_CASE("the error of a rendered pixel of a wall falls faster than 1/N", "[statistical]") {
  const Scene scene = standard_scene("cornell_box");
  const std::vector<double> n{16, 64, 256, 1024};
  const auto slope_of = [&](SamplerKind sampler) {
    std::vector<double> variances;
    for (const double count : n) {
      RenderOptions options;
      options.width = options.height = 64;
      options.crop = Window{0, 0, 3, 20, 7, 21};  // higher than the boxes: no shadow
      options.spp = static_cast<std::uint64_t>(count);
      options.threads = 1;
      options.max_depth = 2;
      options.sampler = sampler;
      options.reuse = {.automatic = false};
      Mean pixels[4];
      for (options.seed = 0; options.seed < 64; ++options.seed) {
        const Film film = render(scene, options).film;
        for (int i = 0; i < 4; ++i) pixels[i].add(film.mean(3 + i, 20).x);
      }
      double sum = 0;
      for (const Mean& pixel : pixels) sum += pixel.variance();
      variances.push_back(sum);
    }
    return slope(n, variances);
  };
  const double sobol = slope_of(SamplerKind::sobol), independent = slope_of(SamplerKind::independent);
  CAPTURE(sobol, independent);
  CHECK(sobol < -1.3);
  CHECK(independent == Approx(-1).margin(0.15));  // of 4 variances, each known to 9 %: 0.04
}
