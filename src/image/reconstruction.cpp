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

/// The equations of some parts of the samples, which are halves or both. `find_weights` has strips of all
/// parts. The film is read once for all.
template <std::size_t parts, class FindWeights>
std::array<PixelEquations, parts> equations_of(const DifferenceSums& sums, const int (&part)[parts],
                                               int threads, FindWeights find_weights) {
  const int w = sums.width(), h = sums.height(), strips = (h + HalfStrip::rows - 1) / HalfStrip::rows;
  std::array<PixelEquations, parts> equations;
  std::array<PixelPlanes, parts> handed_on;
  for (PixelEquations& of_part : equations) of_part = PixelEquations(w, h);
  for (PixelPlanes& planes : handed_on)
    for (PixelPlane& plane : planes) plane = PixelPlane(w, strips);
#pragma omp parallel num_threads(threads)
  {
    std::vector<HalfStrip> read;
    for (const int half : part) read.emplace_back(sums, half);
    RightSide right_side(w);
#pragma omp for schedule(static)
    for (int strip = 0; strip < strips; ++strip) {
      for (HalfStrip& of_part : read) of_part.read(strip * HalfStrip::rows);
      find_weights(read, equations);
      for (std::size_t i = 0; i < parts; ++i) right_side.write(read[i], equations[i], handed_on[i]);
    }
#pragma omp for schedule(static)
    for (int strip = 1; strip < strips; ++strip)
      for (std::size_t i = 0; i < parts; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
          const float* from = handed_on[i][c].row(strip - 1);
          float* b = equations[i].b[c].row(strip * HalfStrip::rows);
          for (int x = 0; x < w; ++x) b[x] += from[x];
        }
  }
  return equations;
}

/// Adds a share of the correction of a part of the samples, a half or both, to the means of row y.
CASTRAY_VECTOR_CLONES
void add_row(const Film& film, int part, const PixelPlanes& correction, float share, int y, Image& image) {
  const Window& window = film.window();
  const RowCounts count(film.differences(), part, y, Term::own);
  const float *red = correction[0].row(y), *green = correction[1].row(y), *blue = correction[2].row(y);
  for (int x = 0; x < film.width(); ++x) {
    const float all = static_cast<float>(film.count(window.x0 + x, window.y0 + y)),
                smooth = static_cast<float>(count[x]) / DifferenceSums::most_takes;
    const float weight = share * smooth / (all > 0 ? all : 1);  // of none there is none
    image.at(x, y) += Vec3f(red[x], green[x], blue[x]) * weight;
  }
}

}  // namespace

bool has_few_samples(const DifferenceSums& sums) {
  constexpr std::uint32_t few = 2 * DifferenceSums::most_takes;
  for (int y = 0; y < sums.height(); ++y) {
    const std::uint32_t* count = sums.counts(1, y, Term::own);
    if (std::any_of(count, count + sums.width(), [](std::uint32_t number) { return number > few; }))
      return false;
  }
  return true;
}

PixelPlanes correction_of_few(const DifferenceSums& sums, int threads) {
  auto equations = equations_of(sums, {both_halves}, threads,
                                [](auto& read, auto& of_parts) { read[0].count_weights(of_parts[0].a); });
  return ScreenedPoisson(sums.width(), sums.height(), threads).solve(std::move(equations[0]));
}

std::array<PixelPlanes, 2> corrections(const DifferenceSums& sums, int threads, WeightsOf weights) {
  auto equations = equations_of(sums, {0, 1}, threads, [weights](auto& read, auto& of_parts) {
    for (int half = 0; half < 2; ++half) {
      const int used_by = weights == WeightsOf::other_half ? 1 - half : half;
      read[static_cast<std::size_t>(half)].find_weights(used_by,
                                                        of_parts[static_cast<std::size_t>(used_by)].a);
    }
  });
  ScreenedPoisson solver(sums.width(), sums.height(), threads);
  PixelPlanes first = solver.solve(std::move(equations[0]));
  return {std::move(first), solver.solve(std::move(equations[1]))};
}

Image image_of(const Film& film, int threads) {
  if (threads <= 0) threads = available_threads();
  const DifferenceSums& sums = film.differences();
  if (!sums.kept()) return film.image(threads);
  if (has_few_samples(sums)) {
    const PixelPlanes correction = correction_of_few(sums, threads);
    const auto scale = static_cast<float>(sums.scale());
    Image image = film.image(threads);  // last, as the solver, which takes most memory, is done with
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int y = 0; y < film.height(); ++y) add_row(film, both_halves, correction, scale, y, image);
    return image;
  }
  const std::array<PixelPlanes, 2> both = corrections(sums, threads);
  const auto share = static_cast<float>(share_of_corrections(sums, both, threads) * sums.scale());
  Image image = film.image(threads);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < film.height(); ++y)
    for (int half = 0; half < 2; ++half)
      add_row(film, half, both[static_cast<std::size_t>(half)], share, y, image);
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
