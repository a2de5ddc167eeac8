#include "image/screened_poisson.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace castray {

namespace {

/// How far each cycle goes in its direction: Chebyshev's polynomial for cycles that leave at most 0.9 of an
/// error. Of what they would leave more of they leave less, too.
constexpr float cycle_steps[] = {6.24f, 1.818f, 1.064f};
/// Of two Jacobi steps, as Chebyshev's polynomial has them for the upper three quarters of the spectrum.
constexpr float first_step = 0.5617f, second_step = 1.389f;
constexpr int worth_threads = 1 << 16;  ///< pixels
constexpr int coarsest_side = 2, coarsest_sweeps = 4;

/// One grid of the hierarchy. Each coarser one has a pixel for every 2x2 (Brandt 1977).
struct Level {
  PixelCouplings a;
  PixelPlane inverse_diagonal;
  PixelPlanes b, x, next;

  explicit Level(PixelCouplings couplings) : a(std::move(couplings)), inverse_diagonal(a.width, a.height) {
    for (int c = 0; c < 3; ++c) x[c] = next[c] = PixelPlane(a.width, a.height);
  }
};

class Multigrid {
 public:
  Multigrid(PixelCouplings couplings, PixelPlanes b, int threads) : threads_(threads) {
    levels_.emplace_back(std::move(couplings));
    levels_[0].b = std::move(b);
    invert_diagonal(levels_[0]);
    while (std::max(levels_.back().a.width, levels_.back().a.height) > coarsest_side) {
      levels_.emplace_back(coarser(levels_.back().a));
      for (PixelPlane& plane : levels_.back().b)
        plane = PixelPlane(levels_.back().a.width, levels_.back().a.height);
      invert_diagonal(levels_.back());
    }
  }

  PixelPlanes solve() {
    Level& finest = levels_[0];
    PixelPlanes before = finest.x;  // zero
    start(finest);
    for (std::size_t i = 0; i < std::size(cycle_steps); ++i) {
      cycle(0, i > 0);
      go_further(finest, before, cycle_steps[i]);
      before = finest.x;
    }
    return before;
  }

 private:
  template <class Row>
  void for_rows(const Level& level, Row row) const {
    const int threads = level.a.width * level.a.height >= worth_threads ? threads_ : 1;
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int y = 0; y < level.a.height; ++y) row(y);
  }

  void invert_diagonal(Level& level) const {
    for_rows(level, [&](int y) {
      const PixelCouplings& a = level.a;
      const float *screen = a.screen.row(y), *right = a.right.row(y), *below = a.below.row(y),
                  *above = a.below.row(y - 1);
      float* inverse = level.inverse_diagonal.row(y);
      for (int x = 0; x < a.width; ++x) {
        const float diagonal = screen[x] + right[x] + right[x - 1] + below[x] + above[x];
        inverse[x] = diagonal > 0 ? 1 / diagonal : 0;
      }
    });
  }

  /// Galerkin's coarse coupling is the sum of the fine ones that cross the border of two blocks: with it a
  /// cycle lessens every error, whatever the couplings.
  PixelCouplings coarser(const PixelCouplings& fine) const {
    PixelCouplings coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
    for (int y = 0; y < fine.height; ++y) {
      const float *right = fine.right.row(y), *below = fine.below.row(y);
      float *screen = coarse.screen.row(y / 2), *to_right = coarse.right.row(y / 2),
            *to_below = coarse.below.row(y / 2);
      for (int x = 0; x < fine.width; ++x) screen[x / 2] += fine.screen.row(y)[x];
      for (int x = 1; x + 1 < fine.width; x += 2) to_right[x / 2] += right[x];
      if (y % 2 == 1 && y + 1 < fine.height)
        for (int x = 0; x < fine.width; ++x) to_below[x / 2] += below[x];
    }
    return coarse;
  }

  /// One step from zero.
  void start(Level& level) const {
    for_rows(level, [&](int y) {
      const float* inverse = level.inverse_diagonal.row(y);
      for (std::size_t c = 0; c < 3; ++c) {
        const float* b = level.b[c].row(y);
        float* x = level.x[c].row(y);
        for (int i = 0; i < level.a.width; ++i) x[i] = first_step * inverse[i] * b[i];
      }
    });
  }

  /// A damped Jacobi step.
  void relax(Level& level, float step) const {
    for_rows(level, [&](int y) {
      const float *right = level.a.right.row(y), *below = level.a.below.row(y),
                  *above = level.a.below.row(y - 1), *inverse = level.inverse_diagonal.row(y);
      for (std::size_t c = 0; c < 3; ++c) {
        const float *b = level.b[c].row(y), *x = level.x[c].row(y), *up = level.x[c].row(y - 1),
                    *down = level.x[c].row(y + 1);
        float* __restrict next = level.next[c].row(y);
        for (int i = 0; i < level.a.width; ++i) {
          const float pull = b[i] + ((right[i] * x[i + 1] + right[i - 1] * x[i - 1]) +
                                     (below[i] * down[i] + above[i] * up[i]));
          next[i] = x[i] + step * (inverse[i] * pull - x[i]);
        }
      }
    });
    std::swap(level.x, level.next);
  }

  /// The sums of the residual over blocks of 2x2, as the coarser grid's b.
  void restrict_residual(const Level& level, Level& coarse) const {
    for_rows(coarse, [&](int y) {
      for (std::size_t c = 0; c < 3; ++c) {
        float* sums = coarse.b[c].row(y);
        std::fill(sums, sums + coarse.a.width, 0.f);
        for (int fine = 2 * y; fine < std::min(2 * y + 2, level.a.height); ++fine)
          add_residual(level, c, fine, sums);
      }
    });
  }

  static void add_residual(const Level& level, std::size_t c, int y, float* sums) {
    const PixelCouplings& a = level.a;
    const float *screen = a.screen.row(y), *right = a.right.row(y), *below = a.below.row(y),
                *above = a.below.row(y - 1), *b = level.b[c].row(y), *x = level.x[c].row(y),
                *up = level.x[c].row(y - 1), *down = level.x[c].row(y + 1);
    const auto residual = [&](int i) {
      return (b[i] - screen[i] * x[i]) + ((right[i] * (x[i + 1] - x[i]) + right[i - 1] * (x[i - 1] - x[i])) +
                                          (below[i] * (down[i] - x[i]) + above[i] * (up[i] - x[i])));
    };
    const int pairs = a.width / 2;
    for (int i = 0; i < pairs; ++i) sums[i] += residual(2 * i) + residual(2 * i + 1);
    if (a.width % 2 == 1) sums[pairs] += residual(a.width - 1);
  }

  void add_coarse(const Level& coarse, Level& level) const {
    for_rows(level, [&](int y) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float* from = coarse.x[c].row(y / 2);
        float* x = level.x[c].row(y);
        for (int i = 0; i < level.a.width; ++i) x[i] += from[i / 2];
      }
    });
  }

  /// Goes from `before` in the direction of the cycle's result.
  void go_further(Level& level, const PixelPlanes& before, float step) const {
    for_rows(level, [&](int y) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float* from = before[c].row(y);
        float* x = level.x[c].row(y);
        for (int i = 0; i < level.a.width; ++i) x[i] = from[i] + step * (x[i] - from[i]);
      }
    });
  }

  /// A V-cycle. `relaxed`: x is not from `start`.
  void cycle(std::size_t i, bool relaxed) {
    Level& level = levels_[i];
    if (relaxed) relax(level, first_step);
    relax(level, second_step);
    if (i + 1 == levels_.size()) {
      for (int sweep = 0; sweep < coarsest_sweeps; ++sweep)
        relax(level, first_step), relax(level, second_step);
      return;
    }
    Level& coarse = levels_[i + 1];
    restrict_residual(level, coarse);
    start(coarse);
    cycle(i + 1, false);
    add_coarse(coarse, level);
    relax(level, second_step);
    relax(level, first_step);
  }

  int threads_;
  std::vector<Level> levels_;
};

}  // namespace

PixelCouplings::PixelCouplings(int w, int h) : width(w), height(h), screen(w, h), right(w, h), below(w, h) {}

PixelPlanes solve_screened_poisson(PixelCouplings couplings, PixelPlanes b, int threads) {
  return Multigrid(std::move(couplings), std::move(b), threads).solve();
}

}  // namespace castray
