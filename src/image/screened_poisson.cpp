#include "image/screened_poisson.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "core/vector_clones.h"

namespace castray {

namespace {

/// How far each cycle goes in its direction: Chebyshev's polynomial for cycles that leave at most 0.7 of an
/// error. Of what they would leave more of they leave less, too. On the first of the coarser grids two cycles
/// instead of one let those of the finest grid leave so little.
constexpr float cycle_steps[] = {2.883f, 1.538f, 1.049f}, coarse_steps[] = {2.484f, 1.114f}, one_step[] = {1};
/// Of two Jacobi steps, as Chebyshev's polynomial has them for the upper three quarters of the spectrum.
constexpr float first_step = 0.5617f, second_step = 1.389f;
constexpr int worth_threads = 1 << 16;  ///< pixels
constexpr int coarsest_side = 2, coarsest_steps = 8;

/// How many rows of b beyond its own a thread needs for the last cycle of a grid; and more for each before
/// it.
constexpr int rows_of_last_cycle = 3, rows_of_a_cycle = 4;
constexpr int rows_outside =
    rows_of_last_cycle + rows_of_a_cycle * (static_cast<int>(std::size(cycle_steps)) - 1);

int threads_for(int width, int height, int threads) { return width * height >= worth_threads ? threads : 1; }

/// One grid of the hierarchy. Each coarser one has a pixel for every 2x2 (Brandt 1977).
struct Level {
  PixelCouplings a;
  PixelPlanes b, x;                 ///< what is left of b when x is taken out of it, and x
  std::vector<PixelPlane> outside;  ///< b of the rows around each thread's, as others change theirs

  /// `finest`: a and b are still to come.
  Level(int width, int height, int threads, bool finest) {
    for (PixelPlane& plane : x) plane = PixelPlane(width, height);
    for (int i = 0; i < threads; ++i) outside.emplace_back(width, 2 * 3 * rows_outside);
    if (finest) return;
    PixelEquations equations(width, height);
    a = std::move(equations.a);
    b = std::move(equations.b);
  }
};

/// The end of the cache line in which a row of so many pixels ends.
int end_of(int width) { return (width + PixelPlane::line - 1) / PixelPlane::line * PixelPlane::line; }

/// The values of a cache line. Loops go over all lines of a row: the values after its last pixel are zero,
/// and stay so.
using Line [[gnu::vector_size(PixelPlane::line * sizeof(float))]] = float;
using HalfLine [[gnu::vector_size(PixelPlane::line / 2 * sizeof(float))]] = float;

// Vectors are returned in arguments: functions for several instruction sets have no one way to return them.

template <class Vector>
void load(const float* from, Vector& values) {
  std::memcpy(&values, from, sizeof values);
}

void load(const Coupling* from, Line& values) {
  static_assert(sizeof(Coupling) == sizeof(std::uint16_t));
  using UpperHalves [[gnu::vector_size(PixelPlane::line * sizeof(std::uint16_t))]] = std::uint16_t;
  using Bits [[gnu::vector_size(sizeof(Line))]] = std::uint32_t;
  UpperHalves upper_halves;
  std::memcpy(&upper_halves, from, sizeof upper_halves);
  const Bits bits = __builtin_convertvector(upper_halves, Bits) << 16;
  std::memcpy(&values, &bits, sizeof values);
}

template <class Vector>
void store(const Vector& values, float* to) {
  std::memcpy(to, &values, sizeof values);
}

/// The last rows of a step, in the cache of a thread. `kept`: how many, a power of 2.
template <int channels, int kept>
class LastRows {
 public:
  explicit LastRows(int width) : plane_(width, number) {}
  float* row(int c, int y) { return plane_.row(c * kept + (y & (kept - 1))); }

  static constexpr int number = channels * kept;

 private:
  PixelPlane plane_;
};
using RecentRows = LastRows<3, 4>;   ///< three to read around one, and one to write
using InverseRows = LastRows<1, 8>;  ///< from the first step of a sweep to the last

/// What a thread that works on the rows begin <= y < end has of its own.
struct Band {
  int begin = 0, end = 0;
  RecentRows started, relaxed, improved, correction;  ///< of a cycle
  RecentRows restarted, prepared;                     ///< of the next one, before its coarser grids
  InverseRows inverse_diagonal;                       ///< found anew by each sweep: sooner than it is read
  PixelPlane residual;                                ///< of three channels
  PixelPlane* outside = nullptr;                      ///< that of the grid

  explicit Band(int width)
      : started(width),
        relaxed(width),
        improved(width),
        correction(width),
        restarted(width),
        prepared(width),
        inverse_diagonal(width),
        residual(width, 3) {}

  bool has(int y) const { return y >= begin && y < end; }
  float* b(Level& level, int c, int y) {
    if (has(y)) return level.b[static_cast<std::size_t>(c)].row(y);
    const int row = rows_outside + y - (y < begin ? begin : end);
    return outside->row(c * 2 * rows_outside + row);
  }
};

/// What the equations of a row say of its values and of those around.
struct RowEquations {
  int end;
  const Coupling *screen, *right, *below, *above;

  RowEquations(const Level& level, int y)
      : end(end_of(level.a.width)),
        screen(level.a.screen.row(y)),
        right(level.a.right.row(y)),
        below(level.a.below.row(y)),
        above(level.a.below.row(y - 1)) {}
};

/// The couplings of a line's pixels to those around.
struct LineCouplings {
  Line left, right, above, below;

  LineCouplings(const RowEquations& a, int i) {
    load(a.right + i - 1, left);
    load(a.right + i, right);
    load(a.above + i, above);
    load(a.below + i, below);
  }
};

/// A line's values and those around.
struct LinesAround {
  Line here, left, right, above, below;

  LinesAround(RecentRows& rows, int c, int y, int i) {
    const float* row = rows.row(c, y);
    load(row + i, here);
    load(row + i - 1, left);
    load(row + i + 1, right);
    load(rows.row(c, y - 1) + i, above);
    load(rows.row(c, y + 1) + i, below);
  }

  void relax(const LineCouplings& a, const Line& inverse_diagonal, const Line& b, float step,
             Line& next) const {
    const Line pull = b + ((a.right * right + a.left * left) + (a.below * below + a.above * above));
    next = here + step * (inverse_diagonal * pull - here);
  }
  /// What the equations make of the values.
  void apply(const LineCouplings& a, const Line& screen, Line& product) const {
    product = screen * here + ((a.right * (here - right) + a.left * (here - left)) +
                               (a.below * (here - below) + a.above * (here - above)));
  }
};

void invert_diagonal(const Level& level, int y, Band& band) {
  const RowEquations a(level, y);
  float* inverse = band.inverse_diagonal.row(0, y);
  for (int i = 0; i < a.end; i += PixelPlane::line) {
    const LineCouplings couplings(a, i);
    Line screen;
    load(a.screen + i, screen);
    const Line diagonal = screen + couplings.right + couplings.left + couplings.below + couplings.above;
    store(diagonal > 0 ? 1 / diagonal : Line{}, inverse + i);
  }
}

/// A damped Jacobi step from zero.
void start_row(Level& level, int y, Band& band, RecentRows& to) {
  const float* inverse_diagonal = band.inverse_diagonal.row(0, y);
  float *b[3], *next[3];
  for (int c = 0; c < 3; ++c) b[c] = band.b(level, c, y), next[c] = to.row(c, y);
  for (int i = 0; i < end_of(level.a.width); i += PixelPlane::line) {
    Line factor;
    load(inverse_diagonal + i, factor);
    factor *= first_step;
    for (int c = 0; c < 3; ++c) {
      Line value;
      load(b[c] + i, value);
      store(factor * value, next[c] + i);
    }
  }
}

/// A damped Jacobi step; `write(line, c, i)` has what comes of line i of a channel.
template <class Write>
void relax_row(Level& level, int y, Band& band, float step, RecentRows& from, Write write) {
  const RowEquations a(level, y);
  const float *b[3], *inverse = band.inverse_diagonal.row(0, y);
  for (int c = 0; c < 3; ++c) b[c] = band.b(level, c, y);
  for (int i = 0; i < a.end; i += PixelPlane::line) {
    const LineCouplings couplings(a, i);
    Line inverse_diagonal;
    load(inverse + i, inverse_diagonal);
    for (int c = 0; c < 3; ++c) {
      Line right_side, next;
      load(b[c] + i, right_side);
      LinesAround(from, c, y, i).relax(couplings, inverse_diagonal, right_side, step, next);
      write(next, c, i);
    }
  }
}

void relax_row(Level& level, int y, Band& band, float step, RecentRows& from, RecentRows& to) {
  float* next[3];
  for (int c = 0; c < 3; ++c) next[c] = to.row(c, y);
  relax_row(level, y, band, step, from, [&](const Line& line, int c, int i) { store(line, next[c] + i); });
}

/// The same, with the corrections of a coarser grid, each of which is that of 2x2 pixels.
void relax_row(Level& level, int y, Band& band, float step, RecentRows& from, const Level& coarse,
               RecentRows& to) {
  float* next[3];
  const float* corrections[3];
  for (int c = 0; c < 3; ++c)
    next[c] = to.row(c, y), corrections[c] = coarse.x[static_cast<std::size_t>(c)].row(y / 2);
  relax_row(level, y, band, step, from, [&](const Line& line, int c, int i) {
    HalfLine half;
    load(corrections[c] + i / 2, half);
    store(line + __builtin_shufflevector(half, half, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7),
          next[c] + i);
  });
  for (float* row : next) row[level.a.width] = 0;
}

/// x goes so far in the direction of the corrections.
void go_further(Level& level, int y, Band& band, float further, bool from_zero) {
  for (int c = 0; c < 3; ++c) {
    const float* correction = band.correction.row(c, y);
    float* x = level.x[static_cast<std::size_t>(c)].row(y);
    for (int i = 0; i < end_of(level.a.width); i += PixelPlane::line) {
      Line value{}, more;
      if (!from_zero) load(x + i, value);
      load(correction + i, more);
      store(value + further * more, x + i);
    }
  }
}

/// `work(product, b, c, i)` has what the equations make of line i of a channel's values, and the line of b.
template <class Work>
void apply_row(Level& level, int y, Band& band, RecentRows& values, Work work) {
  const RowEquations a(level, y);
  float* b[3];
  for (int c = 0; c < 3; ++c) b[c] = band.b(level, c, y);
  for (int i = 0; i < a.end; i += PixelPlane::line) {
    const LineCouplings couplings(a, i);
    Line screen;
    load(a.screen + i, screen);
    for (int c = 0; c < 3; ++c) {
      Line product;
      LinesAround(values, c, y, i).apply(couplings, screen, product);
      work(product, b[c] + i, c, i);
    }
  }
}

/// Takes the corrections, so far as `further` tells, out of b.
void take_out(Level& level, int y, Band& band, float further) {
  apply_row(level, y, band, band.correction, [further](const Line& product, float* b, int, int) {
    Line right_side;
    load(b, right_side);
    store(right_side - further * product, b);
  });
}

/// The sums of what is left over blocks of 2x2 become the coarser grid's b, after the second row of each.
void restrict_row(Level& level, int y, Band& band, Level& coarse) {
  const std::array<float*, 3> residuals{band.residual.row(0), band.residual.row(1), band.residual.row(2)};
  const bool second = y % 2 == 1;
  apply_row(level, y, band, band.prepared, [=](const Line& product, const float* b, int c, int i) {
    Line sum{}, right_side;
    float* const residual = residuals[static_cast<std::size_t>(c)] + i;
    if (second) load(residual, sum);
    load(b, right_side);
    store(sum + (right_side - product), residual);
  });
  if (y % 2 == 0 && y + 1 < level.a.height) return;
  for (int c = 0; c < 3; ++c) {
    const float* residual = band.residual.row(c);
    float* __restrict sums = coarse.b[static_cast<std::size_t>(c)].row(y / 2);
    for (int i = 0; i < end_of(level.a.width) / 2; ++i) sums[i] = residual[2 * i] + residual[2 * i + 1];
  }
}

/// The place of a sweep over the rows of a band. Each step follows the one before it at a distance of one
/// row, so that memory is read once for all.
struct Place {
  int first, row;  ///< of the first step

  /// `work(y)` for the row that step `number` has come to. `to`: what it writes, which is zero around the
  /// image.
  template <class Work>
  void step(int number, const Level& level, RecentRows* to, Work work) const {
    const int y = row - number;
    if (y < first + number) return;
    if (y >= 0 && y < level.a.height) return work(y);
    for (int c = 0; to && c < 3; ++c) std::fill_n(to->row(c, y), end_of(level.a.width), 0.f);
  }
};

/// The first half of a cycle, steps from `number` on: two Jacobi steps from zero, and the coarser grid's b.
void prepare(const Place& place, int number, Level& level, Band& band, Level& coarse) {
  place.step(number, level, &band.restarted, [&](int y) { start_row(level, y, band, band.restarted); });
  place.step(number + 1, level, &band.prepared,
             [&](int y) { relax_row(level, y, band, second_step, band.restarted, band.prepared); });
  place.step(number + 2, level, nullptr, [&](int y) {
    if (band.has(y)) restrict_row(level, y, band, coarse);
  });
}

/// The rows of b around a band, which other threads will change. This one changes its own of them likewise.
void keep_outside(Level& level, Band& band) {
  for (int k = 0; k < rows_outside; ++k)
    for (const int y : {band.begin - rows_outside + k, band.end + k})
      for (int c = 0; c < 3 && y >= 0 && y < level.a.height; ++c)
        std::copy_n(level.b[static_cast<std::size_t>(c)].row(y), end_of(level.a.width), band.b(level, c, y));
}

CASTRAY_VECTOR_CLONES
void sweep_down(Level& level, Band& band, Level& coarse) {
  keep_outside(level, band);
  for (int row = band.begin - 2; row < band.end + 2; ++row) {
    const Place place{band.begin - 2, row};
    place.step(0, level, nullptr, [&](int y) { invert_diagonal(level, y, band); });
    prepare(place, 0, level, band, coarse);
  }
}

/// The second half of a cycle: corrections of coarser grids, and two Jacobi steps. `further`: how far x goes
/// in the direction of the result; it is taken out of b. With it goes the first half of the next cycle, if
/// `more` are to come.
CASTRAY_VECTOR_CLONES
void sweep_up(Level& level, Band& band, float further, bool from_zero, int more, Level& coarse) {
  const int outside = rows_of_last_cycle + more * rows_of_a_cycle;
  for (int row = band.begin - outside; row < band.end + outside; ++row) {
    const Place place{band.begin - outside, row};
    place.step(0, level, nullptr, [&](int y) { invert_diagonal(level, y, band); });
    place.step(0, level, &band.started, [&](int y) { start_row(level, y, band, band.started); });
    place.step(1, level, &band.relaxed,
               [&](int y) { relax_row(level, y, band, second_step, band.started, coarse, band.relaxed); });
    place.step(2, level, &band.improved,
               [&](int y) { relax_row(level, y, band, second_step, band.relaxed, band.improved); });
    place.step(3, level, &band.correction, [&](int y) {
      relax_row(level, y, band, first_step, band.improved, band.correction);
      if (band.has(y)) go_further(level, y, band, further, from_zero);
    });
    if (more == 0) continue;
    place.step(4, level, nullptr, [&](int y) { take_out(level, y, band, further); });
    prepare(place, 4, level, band, coarse);
  }
}

/// Adds values, two of them one after the other, to those of a coarser row.
void add_both(const Coupling* values, int pairs, float* __restrict sums) {
  for (int i = 0; i < pairs; ++i) sums[i] = (sums[i] + values[2 * i]) + values[2 * i + 1];
}

/// Galerkin's coarse coupling is the sum of the fine ones that cross the border of two blocks: with it a
/// cycle lessens every error, whatever the couplings. Row y of the coarser grid. `sums`: three rows.
CASTRAY_VECTOR_CLONES
void couple_coarse(const PixelCouplings& fine, int y, PixelPlane& sums, PixelCouplings& coarse) {
  float *screen = sums.row(0), *to_right = sums.row(1), *to_below = sums.row(2);
  for (float* row : {screen, to_right, to_below}) std::fill_n(row, coarse.width, 0.f);
  for (int row = 2 * y; row < std::min(2 * y + 2, fine.height); ++row) {
    const Coupling* right = fine.right.row(row) + 1;
    add_both(fine.screen.row(row), coarse.width, screen);
    for (int x = 0; x + 1 < coarse.width; ++x) to_right[x] += right[2 * x];
    if (row % 2 == 1 && row + 1 < fine.height) add_both(fine.below.row(row), coarse.width, to_below);
  }
  std::copy_n(screen, coarse.width, coarse.screen.row(y));
  std::copy_n(to_right, coarse.width, coarse.right.row(y));
  std::copy_n(to_below, coarse.width, coarse.below.row(y));
}

}  // namespace

class ScreenedPoisson::Multigrid {
 public:
  Multigrid(int width, int height, int threads) : threads_(threads) {
    for (int w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
      levels_.emplace_back(w, h, threads_for(w, h, threads), levels_.empty());
      if (std::max(w, h) <= coarsest_side) break;
    }
    for (int i = 0; i < threads; ++i) bands_.emplace_back(width);
  }

  PixelPlanes solve(PixelEquations equations) {
    Level& finest = levels_[0];
    if (finest.x[0].values.empty()) finest.x = std::move(finest.b);  // the last solution has taken x with it
    finest.a = std::move(equations.a);
    finest.b = std::move(equations.b);
    for (std::size_t i = 1; i < levels_.size(); ++i) couple(levels_[i - 1], levels_[i]);
    cycles(0);
    return std::move(finest.x);
  }

 private:
  /// `work(band)`, with bands that cover the rows; all begin with an even one.
  template <class Work>
  void for_bands(Level& level, Work work) {
    const int bands = threads_for(level.a.width, level.a.height, threads_), pairs = (level.a.height + 1) / 2;
    const auto begin_of = [&](int k) {
      return 2 * static_cast<int>(static_cast<std::int64_t>(pairs) * k / bands);
    };
#pragma omp parallel for schedule(static, 1) num_threads(bands)
    for (int k = 0; k < bands; ++k) {
      const auto at = static_cast<std::size_t>(k);
      Band& band = bands_[at];
      band.outside = &level.outside[at];
      band.begin = begin_of(k);
      band.end = std::min(begin_of(k + 1), level.a.height);
      work(band);
    }
  }

  void couple(const Level& fine, Level& coarse) {
    for_bands(coarse, [&](Band& band) {
      for (int y = band.begin; y < band.end; ++y) couple_coarse(fine.a, y, band.residual, coarse.a);
    });
  }

  std::span<const float> steps_of(std::size_t i) const {
    if (i == 0) return cycle_steps;
    if (i == 1) return coarse_steps;
    return one_step;
  }

  /// Cycles on level i and coarser ones, from zero.
  void cycles(std::size_t i) {
    if (i + 1 == levels_.size()) return solve_coarsest();
    Level &level = levels_[i], &coarse = levels_[i + 1];
    const std::span<const float> steps = steps_of(i);
    for_bands(level, [&](Band& band) { sweep_down(level, band, coarse); });
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const int more = static_cast<int>(steps.size() - k) - 1;
      cycles(i + 1);
      for_bands(level, [&](Band& band) { sweep_up(level, band, steps[k], k == 0, more, coarse); });
    }
  }

  /// By Gauss-Seidel steps, of which a few are enough for so few pixels.
  void solve_coarsest() {
    Level& level = levels_.back();
    const PixelCouplings& a = level.a;
    Band& band = bands_[0];
    for (int y = 0; y < a.height; ++y) invert_diagonal(level, y, band);
    for (std::size_t c = 0; c < 3; ++c) {
      PixelPlane& x = level.x[c];
      std::fill(x.values.begin(), x.values.end(), 0.f);
      for (int step = 0; step < coarsest_steps; ++step)
        for (int y = 0; y < a.height; ++y)
          for (int i = 0; i < a.width; ++i)
            x.row(y)[i] = band.inverse_diagonal.row(0, y)[i] *
                          (level.b[c].row(y)[i] +
                           (a.right.row(y)[i] * x.row(y)[i + 1] + a.right.row(y)[i - 1] * x.row(y)[i - 1]) +
                           (a.below.row(y)[i] * x.row(y + 1)[i] + a.below.row(y - 1)[i] * x.row(y - 1)[i]));
    }
  }

  int threads_;
  std::vector<Level> levels_;
  std::vector<Band> bands_;  ///< of each thread
};

PixelCouplings::PixelCouplings(int w, int h) : width(w), height(h), screen(w, h), right(w, h), below(w, h) {}

PixelEquations::PixelEquations(int width, int height) : a(width, height) {
  for (PixelPlane& plane : b) plane = PixelPlane(width, height);
}

ScreenedPoisson::ScreenedPoisson(int width, int height, int threads)
    : multigrid_(std::make_unique<Multigrid>(width, height, threads)) {}
ScreenedPoisson::~ScreenedPoisson() = default;
PixelPlanes ScreenedPoisson::solve(PixelEquations equations) {
  return multigrid_->solve(std::move(equations));
}

std::uint64_t bytes_to_solve(int width, int height, int threads) {
  constexpr int steps = 6, rows_of_a_band = steps * RecentRows::number + InverseRows::number + 3;
  std::uint64_t bytes = static_cast<std::uint64_t>(threads) * PixelPlane::bytes_of(width, rows_of_a_band);
  for (int w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
    bytes += 3 * CouplingPlane::bytes_of(w, h) + 2 * 3 * PixelPlane::bytes_of(w, h) +  // b and x
             static_cast<std::uint64_t>(threads_for(w, h, threads)) *
                 PixelPlane::bytes_of(w, 2 * 3 * rows_outside);
    if (std::max(w, h) <= coarsest_side) return bytes;
  }
}

}  // namespace castray
