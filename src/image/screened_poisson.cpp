#include "image/screened_poisson.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

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

/// One grid of the hierarchy. Each coarser one has a pixel for every 2x2 (Brandt 1977).
struct Level {
  PixelCouplings a;
  PixelPlane inverse_diagonal;
  PixelPlanes b, x, next;

  explicit Level(PixelCouplings couplings) : a(std::move(couplings)), inverse_diagonal(a.width, a.height) {
    for (PixelPlanes* planes : {&b, &x, &next})
      for (PixelPlane& plane : *planes) plane = PixelPlane(a.width, a.height);
  }
};

/// The end of the cache line in which a row of so many pixels ends.
int end_of(int width) { return (width + PixelPlane::line - 1) / PixelPlane::line * PixelPlane::line; }

/// The last rows of three channels between two sweeps, in the cache of a thread.
class RecentRows {
 public:
  explicit RecentRows(int width) : plane_(width, 3 * kept) {}
  float* row(std::size_t c, int y) { return plane_.row(static_cast<int>(c) * kept + (y & (kept - 1))); }

  static constexpr int kept = 4;  ///< three to read around one, and one to write; a power of 2

 private:
  PixelPlane plane_;
};

/// What a thread that sweeps over the rows begin <= y < end has between its sweeps.
struct Band {
  int begin = 0, end = 0;
  RecentRows once, twice;  ///< relaxed
  std::vector<float> residual;

  explicit Band(int width) : once(width), twice(width), residual(static_cast<std::size_t>(end_of(width))) {}
};

/// What the equations of a row say of its values and of those around. Loops go to the end of its last cache
/// line: the values after the last pixel are zero and stay so.
struct RowEquations {
  int end;
  const float *screen, *right, *below, *above, *inverse_diagonal, *b;

  RowEquations(const Level& level, std::size_t c, int y)
      : end(end_of(level.a.width)),
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

  RowsAround(const PixelPlane& plane, int y)
      : row(plane.row(y)), up(plane.row(y - 1)), down(plane.row(y + 1)) {}
  RowsAround(RecentRows& rows, std::size_t c, int y)
      : row(rows.row(c, y)), up(rows.row(c, y - 1)), down(rows.row(c, y + 1)) {}
};

/// A damped Jacobi step from zero.
void start(const RowEquations& a, float* __restrict next) {
  for (int i = 0; i < a.end; ++i) next[i] = first_step * a.inverse_diagonal[i] * a.b[i];
}

/// The value of pixel i after a damped Jacobi step.
inline float relaxed(const RowEquations& a, float step, const RowsAround& from, int i) {
  const float *x = from.row, *up = from.up, *down = from.down;
  const float pull = a.b[i] + ((a.right[i] * x[i + 1] + a.right[i - 1] * x[i - 1]) +
                               (a.below[i] * down[i] + a.above[i] * up[i]));
  return x[i] + step * (a.inverse_diagonal[i] * pull - x[i]);
}

void relax(const RowEquations& a, float step, const RowsAround& from, float* __restrict next) {
  for (int i = 0; i < a.end; ++i) next[i] = relaxed(a, step, from, i);
}

/// From `next`, or from zero, so far in the direction of a relaxed row.
void go_further(const RowEquations& a, const RowsAround& from, float further, bool from_zero,
                float* __restrict next) {
  if (from_zero)
    for (int i = 0; i < a.end; ++i) next[i] = further * relaxed(a, first_step, from, i);
  else
    for (int i = 0; i < a.end; ++i) next[i] += further * (relaxed(a, first_step, from, i) - next[i]);
}

void find_residual(const RowEquations& a, const RowsAround& from, float* __restrict residual) {
  const float *x = from.row, *up = from.up, *down = from.down;
  for (int i = 0; i < a.end; ++i)
    residual[i] = (a.b[i] - a.screen[i] * x[i]) +
                  ((a.right[i] * (x[i + 1] - x[i]) + a.right[i - 1] * (x[i - 1] - x[i])) +
                   (a.below[i] * (down[i] - x[i]) + a.above[i] * (up[i] - x[i])));
}

/// Adds values summed over pairs of pixels.
void add_pairs(const float* values, int width, float* __restrict sums) {
  const int pairs = end_of(width) / 2;
  for (int i = 0; i < pairs; ++i) sums[i] += values[2 * i] + values[2 * i + 1];
}

/// x with the corrections of a coarser grid, each of which is that of two pixels.
void add_coarse(const float* x, const float* coarse, int width, float* __restrict sum) {
  const int pairs = end_of(width) / 2;
  for (int i = 0; i < pairs; ++i) {
    sum[2 * i] = x[2 * i] + coarse[i];
    sum[2 * i + 1] = x[2 * i + 1] + coarse[i];
  }
}

CASTRAY_VECTOR_CLONES
void invert(const PixelCouplings& a, int y, float* __restrict inverse) {
  const float *screen = a.screen.row(y), *right = a.right.row(y), *below = a.below.row(y),
              *above = a.below.row(y - 1);
  for (int x = 0; x < end_of(a.width); ++x) {
    const float diagonal = screen[x] + right[x] + right[x - 1] + below[x] + above[x];
    inverse[x] = diagonal > 0 ? 1 / diagonal : 0;
  }
}

/// Adds values, one after the other, to those of a coarser row.
void add_both(const float* values, int width, float* __restrict sums) {
  const int pairs = end_of(width) / 2;
  for (int i = 0; i < pairs; ++i) sums[i] = (sums[i] + values[2 * i]) + values[2 * i + 1];
}

/// Galerkin's coarse coupling is the sum of the fine ones that cross the border of two blocks: with it a
/// cycle lessens every error, whatever the couplings. Row y of the coarser grid.
CASTRAY_VECTOR_CLONES
void couple_coarse(const PixelCouplings& fine, int y, PixelCouplings& coarse) {
  float *screen = coarse.screen.row(y), *to_right = coarse.right.row(y), *to_below = coarse.below.row(y);
  for (float* row : {screen, to_right, to_below}) std::fill_n(row, coarse.width, 0.f);
  for (int row = 2 * y; row < std::min(2 * y + 2, fine.height); ++row) {
    const float* right = fine.right.row(row) + 1;
    add_both(fine.screen.row(row), fine.width, screen);
    for (int x = 0; x + 1 < coarse.width; ++x) to_right[x] += right[2 * x];
    if (row % 2 == 1 && row + 1 < fine.height) add_both(fine.below.row(row), fine.width, to_below);
  }
}

/// A damped Jacobi step from x to `next`.
CASTRAY_VECTOR_CLONES
void step_all(Level& level, float step) {
  for (std::size_t c = 0; c < 3; ++c)
    for (int y = 0; y < level.a.height; ++y)
      relax({level, c, y}, step, {level.x[c], y}, level.next[c].row(y));
}

/// `write(equations, channel, to)` of row y; rows around the image are zero.
template <class Write>
void write_rows(const Level& level, int y, RecentRows& to, Write write) {
  for (std::size_t c = 0; c < 3; ++c) {
    float* row = to.row(c, y);
    if (y < 0 || y >= level.a.height)
      std::fill_n(row, end_of(level.a.width), 0.f);
    else
      write(RowEquations(level, c, y), c, row);
    row[level.a.width] = 0;
  }
}

/// The second of two steps downwards, and the first upwards.
void relax_rows(const Level& level, int y, Band& band) {
  write_rows(level, y, band.twice, [&](const RowEquations& a, std::size_t c, float* next) {
    relax(a, second_step, {band.once, c, y}, next);
  });
}

void restrict_rows(Level& level, int y, Band& band, Level& coarse) {
  for (std::size_t c = 0; c < 3; ++c) {
    std::copy_n(band.twice.row(c, y), end_of(level.a.width), level.next[c].row(y));
    float* sums = coarse.b[c].row(y / 2);
    if (y % 2 == 0) std::fill_n(sums, end_of(level.a.width) / 2, 0.f);
    find_residual({level, c, y}, {band.twice, c, y}, band.residual.data());
    add_pairs(band.residual.data(), level.a.width, sums);
  }
}

/// Two Jacobi steps into `next`, and the sums of the residual over blocks of 2x2 as the coarser grid's b.
/// `from_zero`: from zero, else from x. Each sweep follows the one before it at a distance of one row, so
/// that memory is read once.
CASTRAY_VECTOR_CLONES
void sweep_down(Level& level, bool from_zero, Band& band, Level& coarse) {
  for (int y = band.begin - 2; y < band.end + 2; ++y) {
    write_rows(level, y, band.once, [&](const RowEquations& a, std::size_t c, float* next) {
      if (from_zero)
        start(a, next);
      else
        relax(a, first_step, {level.x[c], y}, next);
    });
    if (y >= band.begin) relax_rows(level, y - 1, band);
    if (y >= band.begin + 2) restrict_rows(level, y - 2, band, coarse);
  }
}

/// Corrections of coarser grids, added to x, and two Jacobi steps. `further`: how far `next` goes in the
/// direction of the result, from where it is or from zero.
CASTRAY_VECTOR_CLONES
void sweep_up(Level& level, float further, bool from_zero, Band& band, const Level& coarse) {
  for (int y = band.begin - 2; y < band.end + 2; ++y) {
    write_rows(level, y, band.once, [&](const RowEquations&, std::size_t c, float* next) {
      add_coarse(level.x[c].row(y), coarse.x[c].row(y / 2), level.a.width, next);
    });
    if (y >= band.begin) relax_rows(level, y - 1, band);
    for (std::size_t c = 0; y >= band.begin + 2 && c < 3; ++c)
      go_further({level, c, y - 2}, {band.twice, c, y - 2}, further, from_zero, level.next[c].row(y - 2));
  }
}

}  // namespace

class ScreenedPoisson::Multigrid {
 public:
  Multigrid(int width, int height, int threads) : threads_(threads) {
    levels_.emplace_back(PixelCouplings(width, height));
    do {
      const PixelCouplings& fine = levels_.back().a;
      levels_.emplace_back(PixelCouplings((fine.width + 1) / 2, (fine.height + 1) / 2));
    } while (std::max(levels_.back().a.width, levels_.back().a.height) > coarsest_side);
    for (int i = 0; i < threads; ++i) bands_.emplace_back(width);
  }

  Level& finest() { return levels_[0]; }

  PixelPlanes solve() {
    for (PixelPlane& x : finest().x)
      if (x.values.empty()) x = PixelPlane(finest().a.width, finest().a.height);
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      if (i > 0) couple(levels_[i - 1].a, levels_[i].a);
      invert_diagonal(levels_[i]);
    }
    cycles(0, cycle_steps);
    return std::move(finest().x);
  }

 private:
  int threads_for(int width, int height) const { return width * height >= worth_threads ? threads_ : 1; }

  /// `work(band)`, with bands that cover the rows; all begin with an even one.
  template <class Work>
  void for_bands(const Level& level, Work work) {
    const int bands = threads_for(level.a.width, level.a.height), pairs = (level.a.height + 1) / 2;
    const auto begin_of = [&](int k) {
      return 2 * static_cast<int>(static_cast<std::int64_t>(pairs) * k / bands);
    };
#pragma omp parallel for schedule(static, 1) num_threads(bands)
    for (int k = 0; k < bands; ++k) {
      Band& band = bands_[static_cast<std::size_t>(k)];
      band.begin = begin_of(k);
      band.end = std::min(begin_of(k + 1), level.a.height);
      work(band);
    }
  }

  void invert_diagonal(Level& level) const {
#pragma omp parallel for schedule(static) num_threads(threads_for(level.a.width, level.a.height))
    for (int y = 0; y < level.a.height; ++y) invert(level.a, y, level.inverse_diagonal.row(y));
  }

  void couple(const PixelCouplings& fine, PixelCouplings& coarse) const {
#pragma omp parallel for schedule(static) num_threads(threads_for(fine.width, fine.height))
    for (int y = 0; y < coarse.height; ++y) couple_coarse(fine, y, coarse);
  }

  /// Cycles on level i and coarser ones, from zero.
  void cycles(std::size_t i, std::span<const float> steps) {
    for (std::size_t k = 0; k < steps.size(); ++k) {
      go_down(i, k == 0);
      go_up(i, steps[k], k == 0);
    }
  }
  std::span<const float> steps_of(const Level& coarse) const {
    if (std::max(coarse.a.width, coarse.a.height) < worth_two_cycles) return one_step;
    return coarse_steps;
  }

  /// The first half of a cycle, with the cycles of coarser grids. `next` is then x before the cycle.
  void go_down(std::size_t i, bool from_zero) {
    Level &level = levels_[i], &coarse = levels_[i + 1];
    for_bands(level, [&](Band& band) { sweep_down(level, from_zero, band, coarse); });
    std::swap(level.x, level.next);
    if (i + 2 < levels_.size())
      cycles(i + 1, steps_of(coarse));
    else
      solve_coarsest();
  }

  void go_up(std::size_t i, float further, bool from_zero) {
    Level &level = levels_[i], &coarse = levels_[i + 1];
    for_bands(level, [&](Band& band) { sweep_up(level, further, from_zero, band, coarse); });
    std::swap(level.x, level.next);
  }

  void solve_coarsest() {
    Level& level = levels_.back();
    for (PixelPlane& x : level.x) std::fill(x.values.begin(), x.values.end(), 0.f);
    for (int sweep = 0; sweep <= coarsest_sweeps; ++sweep)
      for (const float step : {first_step, second_step}) {
        step_all(level, step);
        std::swap(level.x, level.next);
      }
  }

  int threads_;
  std::vector<Level> levels_;
  std::vector<Band> bands_;  ///< of each thread
};

PixelCouplings::PixelCouplings(int w, int h) : width(w), height(h), screen(w, h), right(w, h), below(w, h) {}

ScreenedPoisson::ScreenedPoisson(int width, int height, int threads)
    : multigrid_(std::make_unique<Multigrid>(width, height, threads)) {}
ScreenedPoisson::~ScreenedPoisson() = default;
PixelCouplings& ScreenedPoisson::couplings() { return multigrid_->finest().a; }
PixelPlanes& ScreenedPoisson::b() { return multigrid_->finest().b; }
PixelPlanes& ScreenedPoisson::scratch() { return multigrid_->finest().next; }
PixelPlanes ScreenedPoisson::solve() { return multigrid_->solve(); }

std::uint64_t bytes_to_solve(int width, int height, int threads) {
  constexpr std::uint64_t planes_of_level =
      3 + 1 + 3 * 3;  // couplings, their inverse diagonal, b, x and next
  constexpr int rows_of_a_band = 2 * 3 * RecentRows::kept + 1;  // relaxed once and twice, and the residual
  std::uint64_t bytes = static_cast<std::uint64_t>(threads) * PixelPlane::bytes_of(width, rows_of_a_band);
  for (int w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
    bytes += planes_of_level * PixelPlane::bytes_of(w, h);
    if (std::max(w, h) <= coarsest_side) return bytes;
  }
}

}  // namespace castray
