#include "image/reconstruction.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/threads.h"
#include "core/vector_clones.h"
#include "image/correction_share.h"
#include "image/pair_weights.h"
#include "image/row_means.h"

namespace castray {

namespace {

using Term = DifferenceSums::Term;

constexpr int rows_of_a_strip = 32;

/// The right side of the equations for corrections: what differences say of neighbours, less what means say.
class RightSide {
 public:
  RightSide(const DifferenceSums& sums, int half, const PixelCouplings& weights)
      : sums_(sums),
        half_(half),
        weights_(weights),
        here_(sums.width()),
        next_(sums.width()),
        difference_(sums.width()) {
    for (Pulls* pulls : {&right_, &above_, &below_})
      for (auto& channel : *pulls) channel.resize(static_cast<std::size_t>(sums.width()) + 1);
  }

  /// Rows begin <= y < end of `b`.
  void write(int begin, int end, PixelPlanes& b) {
    const int first = std::max(begin - 1, 0);
    next_.read(sums_, half_, first, Term::own);
    for (int y = first; y < end; ++y) {
      std::swap(here_, next_);
      std::swap(above_, below_);
      const bool any_below = y + 1 < sums_.height();
      if (any_below) next_.read(sums_, half_, y + 1, Term::own);
      if (any_below) difference_.read(sums_, half_, y, Term::below);
      for (std::size_t c = 0; c < 3; ++c)
        if (any_below)
          find_pulls(weights_.below.row(y), c, here_.channel[c].data(), next_.channel[c].data(),
                     sums_.width(), below_[c].data());
        else
          std::fill(below_[c].begin(), below_[c].end(), 0.f);
      if (y < begin) continue;
      difference_.read(sums_, half_, y, Term::right);
      for (std::size_t c = 0; c < 3; ++c) {
        const float* mean = here_.channel[c].data();
        find_pulls(weights_.right.row(y), c, mean, mean + 1, sums_.width() - 1, right_[c].data() + 1);
        add_up(c, b[c].row(y));
      }
    }
  }

 private:
  using Pulls = std::array<std::vector<float>, 3>;

  CASTRAY_VECTOR_CLONES
  void find_pulls(const float* weight, std::size_t c, const float* mean, const float* neighbour, int count,
                  float* __restrict pull) const {
    const float* difference = difference_.channel[c].data();
    for (int x = 0; x < count; ++x) pull[x] = weight[x] * (difference[x] - (neighbour[x] - mean[x]));
  }

  CASTRAY_VECTOR_CLONES
  void add_up(std::size_t c, float* __restrict sum) const {
    const float *above = above_[c].data(), *below = below_[c].data(), *left = right_[c].data(),
                *right = left + 1;
    for (int x = 0; x < sums_.width(); ++x) sum[x] = above[x] + left[x] - right[x] - below[x];
  }

  const DifferenceSums& sums_;
  int half_;
  const PixelCouplings& weights_;
  RowMeans here_, next_, difference_;
  Pulls right_;          ///< between a pixel and the one to its left; zero at both ends
  Pulls above_, below_;  ///< between a pixel and those of the rows around
};

/// Takes out the pairs, and the pixels, of which this half has no samples.
void keep_known(PixelCouplings& weights, const DifferenceSums& sums, int half, int threads) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < sums.height(); ++y) {
    const auto keep = [&](Term term, float* weight) {
      const std::uint32_t* count = sums.counts(half, y, term);
      for (int x = 0; x < sums.width(); ++x) weight[x] = count[x] > 0 ? weight[x] : 0;
    };
    keep(Term::own, weights.screen.row(y));
    keep(Term::right, weights.right.row(y));
    keep(Term::below, weights.below.row(y));
  }
}

/// Whether a half has two samples of any pixel. Of one sample, differences are those of the means.
bool may_need_corrections(const DifferenceSums& sums) {
  const auto& counts = sums.all_counts();
  return std::any_of(counts.begin(), counts.end(), [](std::uint32_t count) { return count > 1; });
}

}  // namespace

PixelPlanes corrections(const DifferenceSums& sums, int half, int half_of_weights, int threads,
                        ScreenedPoisson& solver) {
  const int h = sums.height();
  PixelCouplings& weights = solver.couplings();
  find_weights(sums, half_of_weights, threads, solver.scratch(), weights);
  keep_known(weights, sums, half, threads);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < h; y += rows_of_a_strip)
    RightSide(sums, half, weights).write(y, std::min(y + rows_of_a_strip, h), solver.b());
  return solver.solve();
}

Image image_of(const Film& film, int threads) {
  if (threads <= 0) threads = available_threads();
  Image image = film.image(threads);
  const DifferenceSums& sums = film.differences();
  if (!sums.kept() || !may_need_corrections(sums)) return image;
  const Window& window = film.window();
  ScreenedPoisson solver(film.width(), film.height(), threads);
  PixelPlanes first = corrections(sums, 0, 1, threads, solver);
  const PixelPlanes both[] = {std::move(first), corrections(sums, 1, 0, threads, solver)};
  const auto share = static_cast<float>(share_of_corrections(sums, both, threads) * sums.scale());
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < film.height(); ++y)
    for (int half = 0; half < DifferenceSums::halves; ++half) {
      const PixelPlanes& correction = both[half];
      const std::uint32_t* count = sums.counts(half, y, Term::own);
      for (int x = 0; x < film.width(); ++x) {
        const auto all = static_cast<float>(film.count(window.x0 + x, window.y0 + y));
        const Vec3f more(correction[0].row(y)[x], correction[1].row(y)[x], correction[2].row(y)[x]);
        if (all > 0) image.at(x, y) += more * (share * static_cast<float>(count[x]) / all);
      }
    }
  return image;
}

std::uint64_t bytes_of_image(const Film& like, int width, int height, int threads) {
  const auto w = static_cast<std::uint64_t>(width), pixels = w * static_cast<std::uint64_t>(height);
  constexpr std::uint64_t shown =
      sizeof(Vec3f) + 3 * sizeof(std::uint16_t);  // by the tone curve, and as bytes
  constexpr std::uint64_t noise = sizeof(Vec3f), line_buffers = 1024;
  const std::uint64_t writing = pixels * (shown + (like.keeps_replicates() ? noise : 0)) + w * line_buffers;
  std::uint64_t making = 0;
  if (like.differences().kept()) {
    constexpr std::uint64_t rows_of_a_thread = 9 * sizeof(float) + 3 * (3 + 1) * sizeof(double);
    making = 3 * PixelPlane::bytes_of(width, height) +  // the corrections of the other half
             bytes_to_solve(width, height, threads) +
             static_cast<std::uint64_t>(threads) * w * rows_of_a_thread;
  }
  return pixels * sizeof(Vec3f) + std::max(making, writing);
}

}  // namespace castray
