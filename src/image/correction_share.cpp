#include "image/correction_share.h"

#include <algorithm>
#include <vector>

#include "castray/vec.h"
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

/// What the two halves say of a pixel's radiance.
struct Halves {
  const RowMeans& first;
  const RowMeans& second;

  bool both_know(std::size_t x) const { return first.per_sum[x] > 0 && second.per_sum[x] > 0; }
};

void add_corrections(const Halves& means, const PixelPlanes (&corrections)[2], int y,
                     std::vector<Moments>& blocks) {
  for (std::size_t c = 0; c < 3; ++c) {
    const float *first = corrections[0][c].row(y), *second = corrections[1][c].row(y);
    for (std::size_t x = 0; x < means.first.per_sum.size(); ++x) {
      if (!means.both_know(x)) continue;
      const double one = double{first[x]}, other = double{second[x]};
      Moments& block_of_x = blocks[x / block];
      block_of_x.with_error += (means.first.channel[c][x] - means.second.channel[c][x]) * (one - other);
      block_of_x.squares += one * one + other * other;
    }
  }
}

/// Of the blocks whose first row is y0. The film is read once: it takes longer than all else here.
std::vector<Moments> moments_of_blocks(const DifferenceSums& sums, const PixelPlanes (&corrections)[2],
                                       int y0) {
  const int width = sums.width();
  std::vector<Moments> blocks((static_cast<std::size_t>(width) + block - 1) / block);
  std::vector<double> luminances[2], pixels[2];
  RowMeans means[2] = {RowMeans(width), RowMeans(width)};
  for (std::size_t half = 0; half < 2; ++half)
    luminances[half] = pixels[half] = std::vector<double>(blocks.size());
  for (int y = y0; y < std::min(y0 + block, sums.height()); ++y) {
    for (std::size_t half = 0; half < 2; ++half) {
      means[half].read(sums, static_cast<int>(half), y, DifferenceSums::own);
      const auto& [red, green, blue] = means[half].channel;
      for (std::size_t x = 0; x < red.size(); ++x) {
        luminances[half][x / block] += luminance(Vec3d{red[x], green[x], blue[x]});
        pixels[half][x / block] += means[half].per_sum[x] > 0;
      }
    }
    add_corrections({means[0], means[1]}, corrections, y, blocks);
  }
  for (std::size_t i = 0; i < blocks.size(); ++i)
    blocks[i].brightness =
        luminances[0][i] / std::max(pixels[0][i], 1.0) * luminances[1][i] / std::max(pixels[1][i], 1.0);
  return blocks;
}

}  // namespace

double share_of_corrections(const DifferenceSums& sums, const PixelPlanes (&corrections)[2], int threads) {
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
