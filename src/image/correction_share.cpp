#include "image/correction_share.h"

#include <algorithm>
#include <vector>

#include "castray/vec.h"
#include "core/vector_clones.h"
#include "image/row_means.h"

namespace castray {

namespace {

constexpr int block = 8;          ///< side in pixels of the areas to whose brightness errors are relative
constexpr double darkest = 0.01;  ///< the least square of that, over that of the image

/// Of a block of pixels.
struct Moments {
  /// The square of its luminance: the product of the halves' means, in which a rare bright sample of one of
  /// them counts little.
  double brightness = 0;
  /// Sums over pixels, channels and halves: of corrections times errors, for which a half's mean less the
  /// other's stands, and of squares of corrections.
  double with_error = 0, squares = 0;
};

/// Sums over the columns of a row of blocks.
struct ColumnSums {
  std::vector<float> luminances[2], pixels[2];  ///< of the halves
  std::vector<float> with_error, squares;

  explicit ColumnSums(std::size_t width) : with_error(width), squares(width) {
    for (std::size_t half = 0; half < 2; ++half) luminances[half] = pixels[half] = with_error;
  }

  CASTRAY_VECTOR_CLONES
  void add_means(std::size_t half, const RowMeans& means) {
    const double *red = means.channel[0].data(), *green = means.channel[1].data(),
                 *blue = means.channel[2].data(), *known = means.per_sum.data();
    float* __restrict sum = luminances[half].data(), * __restrict number = pixels[half].data();
    for (std::size_t x = 0; x < means.per_sum.size(); ++x) {
      sum[x] += static_cast<float>(luminance(Vec3d(red[x], green[x], blue[x])));
      number[x] += known[x] > 0 ? 1.f : 0.f;
    }
  }

  /// Of pixels that both halves know.
  CASTRAY_VECTOR_CLONES
  void add_corrections(const RowMeans& first, const RowMeans& second, std::size_t channel,
                       const float* correction, const float* other) {
    const double *mean = first.channel[channel].data(), *other_mean = second.channel[channel].data(),
                 *known = first.per_sum.data(), *other_known = second.per_sum.data();
    float* __restrict products = with_error.data(), * __restrict sum = squares.data();
    for (std::size_t x = 0; x < first.per_sum.size(); ++x) {
      const float both = ((known[x] > 0) & (other_known[x] > 0)) ? 1.f : 0.f;
      products[x] += both * (static_cast<float>(mean[x] - other_mean[x]) * (correction[x] - other[x]));
      sum[x] += both * (correction[x] * correction[x] + other[x] * other[x]);
    }
  }
};

/// Of the blocks whose first row is y0. The film is read once: it takes longer than all else here.
std::vector<Moments> moments_of_blocks(const DifferenceSums& sums,
                                       const std::array<PixelPlanes, 2>& corrections, int y0) {
  const auto width = static_cast<std::size_t>(sums.width());
  ColumnSums columns(width);
  RowMeans means[2] = {RowMeans(sums.width()), RowMeans(sums.width())};
  for (int y = y0; y < std::min(y0 + block, sums.height()); ++y) {
    for (std::size_t half = 0; half < 2; ++half) {
      means[half].read(sums, static_cast<int>(half), y, DifferenceSums::own);
      columns.add_means(half, means[half]);
    }
    for (std::size_t c = 0; c < 3; ++c)
      columns.add_corrections(means[0], means[1], c, corrections[0][c].row(y), corrections[1][c].row(y));
  }
  constexpr std::size_t side = block;
  std::vector<Moments> blocks((width + side - 1) / side);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const auto total = [&](const std::vector<float>& column) {
      double sum = 0;
      for (std::size_t x = i * side; x < std::min((i + 1) * side, width); ++x) sum += double{column[x]};
      return sum;
    };
    const auto mean = [&](std::size_t half) {
      return total(columns.luminances[half]) / std::max(total(columns.pixels[half]), 1.0);
    };
    blocks[i] = {mean(0) * mean(1), total(columns.with_error), total(columns.squares)};
  }
  return blocks;
}

}  // namespace

double share_of_corrections(const DifferenceSums& sums, const std::array<PixelPlanes, 2>& corrections,
                            int threads) {
  const int rows = (sums.height() + block - 1) / block;
  std::vector<std::vector<Moments>> blocks(static_cast<std::size_t>(rows));
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int i = 0; i < rows; ++i)
    blocks[static_cast<std::size_t>(i)] = moments_of_blocks(sums, corrections, i * block);
  double total = 0;  // in the order of rows, whatever the threads
  for (const auto& row : blocks) {
    double of_row = 0;
    for (const Moments& moments : row) of_row += moments.brightness;
    total += of_row / double(row.size());
  }
  const double least = darkest * total / rows;
  if (!(least > 0)) return 0;
  double with_error = 0, squares = 0;
  for (const auto& row : blocks)
    for (const Moments& moments : row) {
      const double weight = 1 / std::max(moments.brightness, least);
      with_error += weight * moments.with_error;
      squares += weight * moments.squares;
    }
  return squares > 0 ? std::clamp(-with_error / squares, 0.0, 1.0) : 0;
}

}  // namespace castray
