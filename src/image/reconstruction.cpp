#include "image/reconstruction.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/threads.h"
#include "core/vector_clones.h"
#include "image/correction_share.h"
#include "image/half_strip.h"

namespace castray {

namespace {

using Term = DifferenceSums::Term;

/// The right side of the equations for corrections: how differences and means contradict each other, weighed.
class RightSide {
 public:
  explicit RightSide(int width) : width_(width) {
    for (Rows* rows : {&right_, &above_, &below_})
      for (auto& channel : *rows) channel.resize(static_cast<std::size_t>(width) + 1);
  }

  /// The rows of a strip. `handed_on`: what the row below it gets besides.
  void write(const HalfStrip& strip, PixelEquations& equations, PixelPlanes& handed_on) {
    for (auto& channel : below_) std::fill(channel.begin(), channel.end(), 0.f);
    for (int y = strip.begin(); y < strip.end(); ++y) {
      std::swap(above_, below_);
      for (std::size_t c = 0; c < 3; ++c) {
        weigh(strip.right_contradiction(c, y), equations.a.right.row(y), width_ - 1, right_[c].data() + 1);
        weigh(strip.below_contradiction(c, y), equations.a.below.row(y), width_, below_[c].data());
        add_up(c, equations.b[c].row(y));
      }
    }
    for (std::size_t c = 0; c < 3; ++c)
      std::copy_n(below_[c].data(), width_, handed_on[c].row(strip.begin() / HalfStrip::rows));
  }

 private:
  using Rows = std::array<std::vector<float>, 3>;

  CASTRAY_VECTOR_CLONES
  static void weigh(const float* contradiction, const Coupling* weight, int count, float* __restrict pull) {
    for (int x = 0; x < count; ++x) pull[x] = weight[x] > 0 ? weight[x] * contradiction[x] : 0;
  }

  CASTRAY_VECTOR_CLONES
  void add_up(std::size_t c, float* __restrict sum) const {
    const float *above = above_[c].data(), *below = below_[c].data(), *left = right_[c].data(),
                *right = left + 1;
    for (int x = 0; x < width_; ++x) sum[x] = above[x] + left[x] - right[x] - below[x];
  }

  int width_;
  Rows right_;          ///< between a pixel and the one to its left; zero at both ends
  Rows above_, below_;  ///< between a pixel and those of the rows around
};

using BothEquations = std::array<PixelEquations, 2>;

/// The film is read once for all.
BothEquations equations_of(const DifferenceSums& sums, int threads, WeightsOf weights_of) {
  const int w = sums.width(), h = sums.height(), strips = (h + HalfStrip::rows - 1) / HalfStrip::rows;
  BothEquations equations = {PixelEquations(w, h), PixelEquations(w, h)};
  std::array<PixelPlanes, 2> handed_on;
  for (PixelPlanes& planes : handed_on)
    for (PixelPlane& plane : planes) plane = PixelPlane(w, strips);
#pragma omp parallel num_threads(threads)
  {
    HalfStrip halves[] = {HalfStrip(sums, 0), HalfStrip(sums, 1)};
    RightSide right_side(w);
#pragma omp for schedule(static)
    for (int strip = 0; strip < strips; ++strip) {
      for (int half = 0; half < 2; ++half) {
        const int used_by = weights_of == WeightsOf::other_half ? 1 - half : half;
        halves[half].read(strip * HalfStrip::rows);
        halves[half].find_weights(used_by, equations[static_cast<std::size_t>(used_by)].a);
      }
      for (std::size_t half = 0; half < 2; ++half)
        right_side.write(halves[half], equations[half], handed_on[half]);
    }
#pragma omp for schedule(static)
    for (int strip = 1; strip < strips; ++strip)
      for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t c = 0; c < 3; ++c) {
          const float* from = handed_on[half][c].row(strip - 1);
          float* b = equations[half].b[c].row(strip * HalfStrip::rows);
          for (int x = 0; x < w; ++x) b[x] += from[x];
        }
  }
  return equations;
}

/// Adds a share of the corrections to the means of row y.
CASTRAY_VECTOR_CLONES
void add_row(const Film& film, const std::array<PixelPlanes, 2>& corrections, float share, int y,
             Image& image) {
  const Window& window = film.window();
  for (std::size_t half = 0; half < 2; ++half) {
    const std::uint32_t* count = film.differences().counts(static_cast<int>(half), y, Term::own);
    const float *red = corrections[half][0].row(y), *green = corrections[half][1].row(y),
                *blue = corrections[half][2].row(y);
    for (int x = 0; x < film.width(); ++x) {
      const float all = static_cast<float>(film.count(window.x0 + x, window.y0 + y));
      const float part = share * static_cast<float>(count[x]) / (all > 0 ? all : 1);  // of none there is none
      image.at(x, y) += Vec3f(red[x], green[x], blue[x]) * part;
    }
  }
}

/// Whether a half has two samples of any pixel. Of one sample, differences are those of the means.
bool may_need_corrections(const DifferenceSums& sums) {
  const auto& counts = sums.all_counts();
  return std::any_of(counts.begin(), counts.end(), [](std::uint32_t count) { return count > 1; });
}

}  // namespace

std::array<PixelPlanes, 2> corrections(const DifferenceSums& sums, int threads, WeightsOf weights) {
  BothEquations equations = equations_of(sums, threads, weights);
  ScreenedPoisson solver(sums.width(), sums.height(), threads);
  PixelPlanes first = solver.solve(std::move(equations[0]));
  return {std::move(first), solver.solve(std::move(equations[1]))};
}

Image image_of(const Film& film, int threads) {
  if (threads <= 0) threads = available_threads();
  const DifferenceSums& sums = film.differences();
  if (!sums.kept() || !may_need_corrections(sums)) return film.image(threads);
  const std::array<PixelPlanes, 2> both = corrections(sums, threads);
  const auto share = static_cast<float>(share_of_corrections(sums, both, threads) * sums.scale());
  Image image = film.image(threads);  // last, as the solver, which takes most memory, is done with
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < film.height(); ++y) add_row(film, both, share, y, image);
  return image;
}

std::uint64_t bytes_of_image(const Film& like, int width, int height, int threads) {
  const auto w = static_cast<std::uint64_t>(width), pixels = w * static_cast<std::uint64_t>(height);
  constexpr std::uint64_t shown =
      sizeof(Vec3f) + 3 * sizeof(std::uint16_t);  // as writers of formats change and pack it
  constexpr std::uint64_t noise = sizeof(Vec3f), line_buffers = 1024;
  const std::uint64_t image = pixels * sizeof(Vec3f),
                      writing = pixels * (shown + (like.keeps_replicates() ? noise : 0)) + w * line_buffers;
  if (!like.differences().kept()) return image + writing;
  const int strips = (height + HalfStrip::rows - 1) / HalfStrip::rows;
  constexpr int planes_of_a_half = 6 * (HalfStrip::rows + 2) + 3 * (HalfStrip::rows + 3),
                vectors_of_a_half = 2 * 3 * (3 + 1) + 6 + 4 + 4, rows_of_right_side = 9;
  const std::uint64_t plane = PixelPlane::bytes_of(width, height),
                      equations = 3 * (CouplingPlane::bytes_of(width, height) + plane);
  const std::uint64_t solving =
      equations + bytes_to_solve(width, height, threads) + 6 * PixelPlane::bytes_of(width, strips) +
      static_cast<std::uint64_t>(threads) *
          PixelPlane::bytes_of(width, 2 * (planes_of_a_half + vectors_of_a_half) + rows_of_right_side);
  return std::max({solving, 2 * 3 * plane + image, image + writing});
}

}  // namespace castray
