#include "image/screened_poisson.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/vector_clones.h"

namespace castray {

namespace {

/// How far each cycle goes in its direction: Chebyshev's polynomial for cycles that leave at most 0.7 of an
/// error. Of what they would leave more of they leave less, too. On coarser grids, which take little time,
/// two cycles instead of one (a W-cycle) let those of the finest grid leave so little.
constexpr float cycle_steps[] = {2.883f, 1.538f, 1.049f}, coarse_steps[] = {2.484f, 1.114f}, one_step[] = {1};
constexpr int worth_two_cycles = 16;  ///< side in pixels
/// Of two Jacobi steps, as Chebyshev's polynomial has them for the upper three quarters of the spectrum.
constexpr float first_step = 0.5617f, second_step = 1.389f;
constexpr int worth_threads = 1 << 16;  ///< pixels
constexpr int coarsest_side = 2, coarsest_sweeps = 4;
constexpr int rows_of_a_strip = 16, rows_around = 2;  ///< even

/// One grid of the hierarchy. Each coarser one has a pixel for every 2x2 (Brandt 1977).
struct Level {
  PixelCouplings a;
  PixelPlane inverse_diagonal;
  PixelPlanes b, x, next;

  explicit Level(PixelCouplings couplings) : a(std::move(couplings)), inverse_diagonal(a.width, a.height) {
    for (int c = 0; c < 3; ++c) x[c] = next[c] = PixelPlane(a.width, a.height);
  }
};

/// One plane of a strip of rows and of those around it, in the cache of a thread.
class StripPlane {
 public:
  explicit StripPlane(int width) : plane_(width, rows_of_a_strip + 2 * rows_around) {}
  void begin_at(int y) { first_ = y - rows_around; }
  float* row(int y) { return plane_.row(y - first_); }

 private:
  PixelPlane plane_;
  int first_ = 0;
};

/// Where sweeps over the rows begin <= y < end put what is between them.
struct Strip {
  int begin = 0, end = 0;
  StripPlane even, odd;

  explicit Strip(int width) : even(width), odd(width) {}
};

/// What the equations of a row say of its values and of those around.
struct RowEquations {
  int width;
  const float *screen, *right, *below, *above, *inverse_diagonal, *b;

  RowEquations(const Level& level, std::size_t c, int y)
      : width(level.a.width),
        screen(level.a.screen.row(y)),
        right(level.a.right.row(y)),
        below(level.a.below.row(y)),
        above(level.a.below.row(y - 1)),
        inverse_diagonal(level.inverse_diagonal.row(y)),
        b(level.b[c].row(y)) {}
};

/// A row and those above and below it.
struct RowsAround {
  const float *row, *up, *down;

  template <class Plane>
  RowsAround(Plane& plane, int y) : row(plane.row(y)), up(plane.row(y - 1)), down(plane.row(y + 1)) {}
};

/// A damped Jacobi step from zero.
CASTRAY_VECTOR_CLONES
void start(const RowEquations& a, float* __restrict next) {
  for (int i = 0; i < a.width; ++i) next[i] = first_step * a.inverse_diagonal[i] * a.b[i];
}

/// A damped Jacobi step.
CASTRAY_VECTOR_CLONES
void relax(const RowEquations& a, float step, const RowsAround& from, float* __restrict next) {
  const float *x = from.row, *up = from.up, *down = from.down;
  for (int i = 0; i < a.width; ++i) {
    const float pull = a.b[i] + ((a.right[i] * x[i + 1] + a.right[i - 1] * x[i - 1]) +
                                 (a.below[i] * down[i] + a.above[i] * up[i]));
    next[i] = x[i] + step * (a.inverse_diagonal[i] * pull - x[i]);
  }
}

/// Adds the residual, summed over pairs of pixels.
CASTRAY_VECTOR_CLONES
void add_residual(const RowEquations& a, const RowsAround& from, float* __restrict sums) {
  const float *x = from.row, *up = from.up, *down = from.down;
  const auto residual = [&](int i) {
    return (a.b[i] - a.screen[i] * x[i]) +
           ((a.right[i] * (x[i + 1] - x[i]) + a.right[i - 1] * (x[i - 1] - x[i])) +
            (a.below[i] * (down[i] - x[i]) + a.above[i] * (up[i] - x[i])));
  };
  const int pairs = a.width / 2;
  for (int i = 0; i < pairs; ++i) sums[i] += residual(2 * i) + residual(2 * i + 1);
  if (a.width % 2 == 1) sums[pairs] += residual(a.width - 1);
}

/// x with the corrections of a coarser grid, each of which is that of two pixels.
CASTRAY_VECTOR_CLONES
void add_coarse(const float* x, const float* coarse, int width, float* __restrict sum) {
  for (int i = 0; i + 1 < width; i += 2) {
    sum[i] = x[i] + coarse[i / 2];
    sum[i + 1] = x[i + 1] + coarse[i / 2];
  }
  if (width % 2 == 1) sum[width - 1] = x[width - 1] + coarse[width / 2];
}

/// next + further (x - next).
CASTRAY_VECTOR_CLONES
void go_further(const float* x, float further, int width, float* __restrict next) {
  for (int i = 0; i < width; ++i) next[i] += further * (x[i] - next[i]);
}

class Multigrid {
 public:
  Multigrid(PixelCouplings couplings, PixelPlanes b, int threads) : threads_(threads) {
    levels_.emplace_back(std::move(couplings));
    levels_[0].b = std::move(b);
    invert_diagonal(levels_[0]);
    do {
      levels_.emplace_back(coarser(levels_.back().a));
      for (PixelPlane& plane : levels_.back().b)
        plane = PixelPlane(levels_.back().a.width, levels_.back().a.height);
      invert_diagonal(levels_.back());
    } while (std::max(levels_.back().a.width, levels_.back().a.height) > coarsest_side);
  }

  PixelPlanes solve() {
    cycles(0, cycle_steps);
    return std::move(levels_[0].x);
  }

 private:
  int threads_for(const Level& level) const {
    return level.a.width * level.a.height >= worth_threads ? threads_ : 1;
  }

  /// `work(strip, c)`: what is to be done to a channel of a strip. Several sweeps of a strip, one after the
  /// other, read memory once; rows around it are then swept twice.
  template <class Work>
  void for_strips(const Level& level, Work work) const {
#pragma omp parallel num_threads(threads_for(level))
    {
      Strip strip(level.a.width);
#pragma omp for schedule(static)
      for (int y = 0; y < level.a.height; y += rows_of_a_strip) {
        strip.begin = y;
        strip.end = std::min(y + rows_of_a_strip, level.a.height);
        strip.even.begin_at(y);
        strip.odd.begin_at(y);
        for (std::size_t c = 0; c < 3; ++c) work(strip, c);
      }
    }
  }

  void invert_diagonal(Level& level) const {
#pragma omp parallel for schedule(static) num_threads(threads_for(level))
    for (int y = 0; y < level.a.height; ++y) {
      const PixelCouplings& a = level.a;
      const float *screen = a.screen.row(y), *right = a.right.row(y), *below = a.below.row(y),
                  *above = a.below.row(y - 1);
      float* inverse = level.inverse_diagonal.row(y);
      for (int x = 0; x < a.width; ++x) {
        const float diagonal = screen[x] + right[x] + right[x - 1] + below[x] + above[x];
        inverse[x] = diagonal > 0 ? 1 / diagonal : 0;
      }
    }
  }

  /// Galerkin's coarse coupling is the sum of the fine ones that cross the border of two blocks: with it a
  /// cycle lessens every error, whatever the couplings.
  PixelCouplings coarser(const PixelCouplings& fine) const {
    PixelCouplings coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
#pragma omp parallel for schedule(static) num_threads(threads_for(levels_.back()))
    for (int y = 0; y < coarse.height; ++y) {
      float *screen = coarse.screen.row(y), *to_right = coarse.right.row(y), *to_below = coarse.below.row(y);
      for (int row = 2 * y; row < std::min(2 * y + 2, fine.height); ++row) {
        const float *right = fine.right.row(row), *below = fine.below.row(row);
        for (int x = 0; x < fine.width; ++x) screen[x / 2] += fine.screen.row(row)[x];
        for (int x = 1; x + 1 < fine.width; x += 2) to_right[x / 2] += right[x];
        if (row % 2 == 1 && row + 1 < fine.height)
          for (int x = 0; x < fine.width; ++x) to_below[x / 2] += below[x];
      }
    }
    return coarse;
  }

  /// Cycles on level i and coarser ones, from zero.
  void cycles(std::size_t i, std::span<const float> steps) {
    for (std::size_t k = 0; k < steps.size(); ++k) {
      go_down(i, k > 0);
      go_up(i, steps[k], k > 0);
    }
  }
  std::span<const float> steps_of(const Level& coarse) const {
    if (std::max(coarse.a.width, coarse.a.height) < worth_two_cycles) return one_step;
    return coarse_steps;
  }

  /// The first half of a cycle, with the cycles of coarser grids: two Jacobi steps, and the sums of the
  /// residual over blocks of 2x2 as the coarser grid's b. `relaxed`: from x, else from zero.
  void go_down(std::size_t i, bool relaxed) {
    Level &level = levels_[i], &coarse = levels_[i + 1];
    for_strips(level, [&](Strip& strip, std::size_t c) {
      for_rows(level, c, strip, 2, strip.even, [&](const RowEquations& a, int y, float* next) {
        if (relaxed)
          relax(a, first_step, {level.x[c], y}, next);
        else
          start(a, next);
      });
      relax_rows(level, c, strip);
      for (int y = strip.begin; y < strip.end; ++y) {
        std::copy_n(strip.odd.row(y), level.a.width, level.next[c].row(y));
        float* sums = coarse.b[c].row(y / 2);
        if (y % 2 == 0) std::fill_n(sums, coarse.a.width, 0.f);
        add_residual({level, c, y}, {strip.odd, y}, sums);
      }
    });
    std::swap(level.x, level.next);
    if (i + 2 < levels_.size())
      cycles(i + 1, steps_of(coarse));
    else
      solve_coarsest();
  }

  /// The second half: corrections of coarser grids, and two Jacobi steps. `further`: how far to go from the x
  /// before the cycle, which `go_down` has put into `next`, in the direction of the result. `relaxed`: that x
  /// counts, else zero in its place.
  void go_up(std::size_t i, float further, bool relaxed) {
    Level &level = levels_[i], &coarse = levels_[i + 1];
    for_strips(level, [&](Strip& strip, std::size_t c) {
      for_rows(level, c, strip, 2, strip.even, [&](const RowEquations& a, int y, float* next) {
        add_coarse(level.x[c].row(y), coarse.x[c].row(y / 2), a.width, next);
      });
      relax_rows(level, c, strip);
      for (int y = strip.begin; y < strip.end; ++y) {
        float *next = level.next[c].row(y), *x = strip.even.row(y);
        relax({level, c, y}, first_step, {strip.odd, y}, x);
        if (!relaxed) std::fill_n(next, level.a.width, 0.f);
        go_further(x, further, level.a.width, next);
      }
    });
    std::swap(level.x, level.next);
  }

  /// `write(equations, y, to)` for the rows of a strip and `around` more on both sides, but that rows around
  /// the image are zero.
  template <class Write>
  static void for_rows(const Level& level, std::size_t c, const Strip& strip, int around, StripPlane& to,
                       Write write) {
    for (int y = strip.begin - around; y < strip.end + around; ++y)
      if (y < 0 || y >= level.a.height)
        std::fill_n(to.row(y), level.a.width, 0.f);
      else
        write({level, c, y}, y, to.row(y));
  }

  /// The second of two steps downwards, and the first upwards.
  static void relax_rows(const Level& level, std::size_t c, Strip& strip) {
    for_rows(level, c, strip, 1, strip.odd, [&](const RowEquations& a, int y, float* next) {
      relax(a, second_step, {strip.even, y}, next);
    });
  }

  void solve_coarsest() {
    Level& level = levels_.back();
    for (std::size_t c = 0; c < 3; ++c) {
      PixelPlane &x = level.x[c], &next = level.next[c];
      const auto step_all = [&](float step) {
        for (int y = 0; y < level.a.height; ++y) relax({level, c, y}, step, {x, y}, next.row(y));
        std::swap(x, next);
      };
      std::fill(x.values.begin(), x.values.end(), 0.f);
      for (int sweep = 0; sweep <= coarsest_sweeps; ++sweep) step_all(first_step), step_all(second_step);
    }
  }

  int threads_;
  std::vector<Level> levels_;
};

}  // namespace

PixelCouplings::PixelCouplings(int w, int h) : width(w), height(h), screen(w, h), right(w, h), below(w, h) {}

PixelPlanes solve_screened_poisson(PixelCouplings couplings, PixelPlanes b, int threads) {
  return Multigrid(std::move(couplings), std::move(b), threads).solve();
}

std::uint64_t bytes_to_solve(int width, int height, int threads) {
  constexpr std::uint64_t planes_of_level =
      3 + 1 + 3 * 3;  // couplings, their inverse diagonal, b, x and next
  std::uint64_t bytes = static_cast<std::uint64_t>(threads) * 2 *
                        PixelPlane::bytes_of(width, rows_of_a_strip + 2 * rows_around);
  for (int w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
    bytes += planes_of_level * PixelPlane::bytes_of(w, h);
    if (std::max(w, h) <= coarsest_side) return bytes;
  }
}

}  // namespace castray
