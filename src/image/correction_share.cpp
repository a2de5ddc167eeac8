#include "image/correction_share.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "castray/vec.h"
#include "image/row_means.h"

namespace castray {

namespace {

constexpr int block = 8;          ///< side in pixels of the areas to whose brightness errors are relative
constexpr double darkest = 0.01;  ///< the least square of that, over that of the image

/// The square of the luminance of each block of a row of blocks: the product of the halves' means, in which
/// a rare bright sample of one of them counts little.
std::vector<double> brightness_of_blocks(const DifferenceSums& sums, int y0) {
  const int width = sums.width();
  std::vector<double> product((static_cast<std::size_t>(width) + block - 1) / block, 1.0);
  for (int half = 0; half < DifferenceSums::halves; ++half) {
    std::vector<double> luminances(product.size()), pixels(product.size());
    RowMeans means(width);
    for (int y = y0; y < std::min(y0 + block, sums.height()); ++y) {
      means.read(sums, half, y, DifferenceSums::own);
      for (std::size_t x = 0; x < means.per_sum.size(); ++x) {
        luminances[x / block] +=
            luminance(Vec3d{means.channel[0][x], means.channel[1][x], means.channel[2][x]});
        pixels[x / block] += means.per_sum[x] > 0;
      }
    }
    for (std::size_t i = 0; i < product.size(); ++i) product[i] *= luminances[i] / std::max(pixels[i], 1.0);
  }
  return product;
}

/// Sums over pixels, channels and halves.
struct Moments {
  double with_error = 0;  ///< of corrections times errors, for which a half's mean less the other's stands
  double squares = 0;     ///< of corrections
};

Moments moments_of_row(const DifferenceSums& sums, const PixelPlanes (&corrections)[2], int y,
                       const std::vector<double>& brightness, double least) {
  const int width = sums.width();
  RowMeans means[2] = {RowMeans(width), RowMeans(width)};
  for (int half = 0; half < 2; ++half) means[half].read(sums, half, y, DifferenceSums::own);
  Moments moments;
  for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
    if (!(means[0].per_sum[x] > 0) || !(means[1].per_sum[x] > 0)) continue;
    const double weight = 1 / std::max(brightness[x / block], least);
    for (std::size_t c = 0; c < 3; ++c) {
      const double first = double{corrections[0][c].row(y)[x]}, second = double{corrections[1][c].row(y)[x]};
      moments.with_error += weight * (means[0].channel[c][x] - means[1].channel[c][x]) * (first - second);
      moments.squares += weight * (first * first + second * second);
    }
  }
  return moments;
}

}  // namespace

double share_of_corrections(const DifferenceSums& sums, const PixelPlanes (&corrections)[2], int threads) {
  const int rows = (sums.height() + block - 1) / block;
  std::vector<std::vector<double>> brightness(static_cast<std::size_t>(rows));
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int i = 0; i < rows; ++i)
    brightness[static_cast<std::size_t>(i)] = brightness_of_blocks(sums, i * block);
  double total = 0;  // in the order of rows, whatever the threads
  for (const auto& row : brightness)
    total += std::accumulate(row.begin(), row.end(), 0.0) / double(row.size());
  const double least = darkest * total / rows;
  if (!(least > 0)) return 0;
  std::vector<Moments> moments(static_cast<std::size_t>(sums.height()));
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < sums.height(); ++y)
    moments[static_cast<std::size_t>(y)] =
        moments_of_row(sums, corrections, y, brightness[static_cast<std::size_t>(y / block)], least);
  Moments sum;
  for (const Moments& row : moments) {
    sum.with_error += row.with_error;
    sum.squares += row.squares;
  }
  return sum.squares > 0 ? std::clamp(-sum.with_error / sum.squares, 0.0, 1.0) : 0;
}

}  // namespace castray
