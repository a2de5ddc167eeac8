#include "image/half_film.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace castray {

namespace {

using Sums = DifferenceSums::Pixel;
using Side = DifferenceSums::Side;

/// Variances of relative differences are four times those of relative differences of square roots.
constexpr float of_roots = 4;

/// Sums over 3x3 pixels of row y, of those that are in the image.
void add_up_3x3(const PixelPlane& plane, int width, int y, std::vector<float>& columns, float* sums) {
  const float *above = plane.row(y - 1), *here = plane.row(y), *below = plane.row(y + 1);
  for (int x = -1; x <= width; ++x) columns[static_cast<std::size_t>(x + 1)] = above[x] + here[x] + below[x];
  for (int x = 0; x < width; ++x) {
    const float* column = &columns[static_cast<std::size_t>(x)];
    sums[x] = column[0] + column[1] + column[2];
  }
}

/// Sums of squares and their degrees of freedom, per pixel.
struct Spread {
  PixelPlane squares, freedom;
  Spread(int width, int height) : squares(width, height), freedom(width, height) {}

  /// The variance of a sample: that of 3x3 pixels, or the pixel's own if that is greater.
  void write_variance(PixelPlane& result, int width, int height, int threads) const {
#pragma omp parallel num_threads(threads)
    {
      std::vector<float> columns(static_cast<std::size_t>(width) + 2),
          degrees(static_cast<std::size_t>(width));
#pragma omp for schedule(static)
      for (int y = 0; y < height; ++y) {
        float* out = result.row(y);
        add_up_3x3(squares, width, y, columns, out);
        add_up_3x3(freedom, width, y, columns, degrees.data());
        const float *square = squares.row(y), *own = freedom.row(y);
        for (int x = 0; x < width; ++x) {
          const float all = degrees[static_cast<std::size_t>(x)];
          const float around = all > 0 ? out[x] / all : std::numeric_limits<float>::infinity();
          out[x] = std::max(around, own[x] > 0 ? square[x] / own[x] : 0);
        }
      }
    }
  }
};

/// The mean of (sqrt q - sqrt(c p))^2 over that of q, times `of_roots`, c = q / p the ratio of the sums: from
/// sums of luminance and of squared differences of its roots.
float relative_spread(float p, float q, float squared_differences) {
  if (!(p > 0 && q > 0)) return of_roots;
  const float root_c = std::sqrt(q / p), change = root_c - 1;
  return of_roots * std::max(root_c * squared_differences / q - change * change / root_c, 0.f);
}

/// A row of three planes.
struct Row {
  float* channel[3];

  Row(PixelPlanes& planes, int y) : channel{planes[0].row(y), planes[1].row(y), planes[2].row(y)} {}
  void set(int x, const Vec3f& v) const {
    channel[0][x] = v.x;
    channel[1][x] = v.y;
    channel[2][x] = v.z;
  }
  Vec3f operator[](int x) const { return {channel[0][x], channel[1][x], channel[2][x]}; }
};

/// Where the sums of a row's pairs go.
struct PairRow {
  float* count;
  Row here, there;
  float *squares, *freedom;

  PairRow(HalfFilm::Pairs& pairs, Spread& spread, int y)
      : count(pairs.count.row(y)),
        here(pairs.here, y),
        there(pairs.there, y),
        squares(spread.squares.row(y)),
        freedom(spread.freedom.row(y)) {}

  /// `p`, `q`: sums over the n samples of the pair.
  void set(int x, float n, const Vec3f& p, const Vec3f& q, const Vec3f& p_mean, const Vec3f& q_mean,
           float squared_differences) const {
    if (!(n > 0)) return;
    count[x] = n;
    here.set(x, p / n - p_mean);
    there.set(x, q / n - q_mean);
    squares[x] = n * relative_spread(luminance(p), luminance(q), squared_differences);
    freedom[x] = n - 1;
  }
};

/// Reads the sums of one half once, row by row.
class Reader {
 public:
  Reader(const Film& film, int half)
      : sums_(film.differences()),
        half_(half),
        width_(film.width()),
        radiance_unit_(sums_.radiance_unit()),
        root_unit_(static_cast<float>(sums_.root_unit())),
        spread_unit_(static_cast<float>(sums_.spread_unit())) {}

  void read_means(int y, HalfFilm& to, Spread& own) const {
    const Row mean(to.mean, y);
    float *count = to.count.row(y), *squares = own.squares.row(y), *freedom = own.freedom.row(y);
    for (int x = 0; x < width_; ++x) {
      const Sums& p = at(x, y);
      const auto n = static_cast<float>(p.count);
      if (!(n > 0)) continue;
      const Vec3f radiance = all(p) / n;
      const float brightness = luminance(radiance), root = static_cast<float>(p.root) * root_unit_ / n;
      count[x] = n;
      mean.set(x, radiance);
      squares[x] = of_roots * n * (brightness > 0 ? std::max(1 - root * root / brightness, 0.f) : 1);
      freedom[x] = n - 1;
    }
  }

  /// Once the means are there.
  void read_pairs_right(int y, HalfFilm& to, Spread& spread) const {
    const Row mean(to.mean, y);
    const PairRow pairs(to.right, spread, y);
    for (int x = 0; x + 1 < width_; ++x)
      pairs.set(x, static_cast<float>(at(x, y).with_right), with(x, y, Side::right),
                with(x + 1, y, Side::left), mean[x], mean[x + 1],
                static_cast<float>(at(x, y).spread_right) * spread_unit_);
  }
  void read_pairs_below(int y, HalfFilm& to, Spread& spread) const {
    const Row mean(to.mean, y), next(to.mean, y + 1);
    const PairRow pairs(to.below, spread, y);
    for (int x = 0; x < width_; ++x)
      pairs.set(x, static_cast<float>(at(x, y).with_below), with(x, y, Side::below),
                with(x, y + 1, Side::above), mean[x], next[x],
                static_cast<float>(at(x, y).spread_below) * spread_unit_);
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  const Sums& at(int x, int y) const { return sums_.at(index(x, y), half_); }
  Vec3f radiance(double r, double g, double b) const { return Vec3f(Vec3d(r, g, b) * radiance_unit_); }
  Vec3f all(const Sums& p) const {
    return radiance(static_cast<double>(p.all[0]), static_cast<double>(p.all[1]),
                    static_cast<double>(p.all[2]));
  }
  /// Over the samples whose tile has the neighbour on a side.
  Vec3f with(int x, int y, Side side) const {
    const auto& sum = at(x, y).all;
    const auto& apart = sums_.apart_at(index(x, y), half_).sum[side];
    return radiance(static_cast<double>(sum[0] - apart[0]), static_cast<double>(sum[1] - apart[1]),
                    static_cast<double>(sum[2] - apart[2]));
  }

  const DifferenceSums& sums_;
  int half_, width_;
  double radiance_unit_;
  float root_unit_, spread_unit_;
};

/// How many of the 3x3 pixels around place i of n are in the image, along one side.
int neighbours(int i, int n) { return std::min(i + 1, n - 1) - std::max(i - 1, 0) + 1; }

/// Of the whole image, added up in a fixed order.
float mean_luminance(const PixelPlanes& mean, int w, int h) {
  double sum = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      sum += static_cast<double>(luminance(Vec3f(mean[0].row(y)[x], mean[1].row(y)[x], mean[2].row(y)[x])));
  return static_cast<float>(sum / (static_cast<double>(w) * h));
}

/// Also writes the guide's luminance.
void write_guide(HalfFilm& film, PixelPlane& brightness, int w, int h, int threads) {
  constexpr float least_part = 1e-3f;  // of the luminance
  const float least = 0.01f * mean_luminance(film.mean, w, h) + 1e-30f;
#pragma omp parallel num_threads(threads)
  {
    std::vector<float> columns(static_cast<std::size_t>(w) + 2);
#pragma omp for schedule(static)
    for (int y = 0; y < h; ++y) {
      const Row guide(film.guide, y);
      for (std::size_t c = 0; c < 3; ++c) add_up_3x3(film.mean[c], w, y, columns, guide.channel[c]);
      float* bright = brightness.row(y);
      for (int x = 0; x < w; ++x) {
        const Vec3f around = guide[x] / static_cast<float>(neighbours(x, w) * neighbours(y, h));
        const float floor = least_part * luminance(around) + least;
        guide.set(x, {std::max(around.x, floor), std::max(around.y, floor), std::max(around.z, floor)});
        bright[x] = luminance(guide[x]);
      }
    }
  }
}

/// As if pairs had one more sample, with the contrast of the guide: at an edge a few samples may all have
/// missed one side.
void add_contrast(Spread& spread, const PixelPlane& brightness, int width, int height, int dx, int dy,
                  int threads) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < height - dy; ++y) {
    const float *here = brightness.row(y), *there = brightness.row(y + dy) + dx;
    float *squares = spread.squares.row(y), *freedom = spread.freedom.row(y);
    for (int x = 0; x < width - dx; ++x) {
      const float contrast = (there[x] - here[x]) / std::min(there[x], here[x]);
      squares[x] += contrast * contrast;
      freedom[x] += 1;
    }
  }
}

}  // namespace

HalfFilm::HalfFilm(const Film& film, int half, int threads) {
  const int w = film.width(), h = film.height();
  for (PixelPlane* plane : {&count, &noise, &right.count, &right.noise, &below.count, &below.noise})
    *plane = PixelPlane(w, h);
  for (PixelPlanes* planes : {&mean, &guide, &right.here, &right.there, &below.here, &below.there})
    for (PixelPlane& plane : *planes) plane = PixelPlane(w, h);
  Spread own(w, h), to_right(w, h), to_below(w, h);
  PixelPlane brightness(w, h);
  const Reader reader(film, half);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < h; ++y) {
    reader.read_means(y, *this, own);
    reader.read_pairs_right(y, *this, to_right);
  }
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < h - 1; ++y) reader.read_pairs_below(y, *this, to_below);
  write_guide(*this, brightness, w, h, threads);
  add_contrast(to_right, brightness, w, h, 1, 0, threads);
  add_contrast(to_below, brightness, w, h, 0, 1, threads);
  own.write_variance(noise, w, h, threads);
  to_right.write_variance(right.noise, w, h, threads);
  to_below.write_variance(below.noise, w, h, threads);
}

}  // namespace castray
