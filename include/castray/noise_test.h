#pragma once

#include <cstddef>

#include "castray/film.h"

namespace castray {

/// Whether two films or images with known noise differ by more than the noise explains.
struct NoiseTest {
  double alpha = 0;       ///< family-wise false-alarm rate: two renders of one scene fail at most this often
  std::size_t tests = 0;  ///< blocks of all sizes times channels
  bool paired = false;    ///< replicates of one seed were compared pairwise
  double p = 1;           ///< smallest p-value, corrected for the number of tests (Bonferroni), at most 1
  bool differs() const { return p < alpha; }
  double rms_t =
      0;  ///< root mean square of t over blocks of 8x8 pixels and channels; about 1 for noise alone

  // Where p is smallest:
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< pixels of the full image
  int channel = 0;
  double t = 0;                         ///< difference of the means in standard errors
  double mean = 0, mean_reference = 0;  ///< radiance
};

/// Compares the mean of each block of 8x8, 16x16, ... pixels, up to the whole window, in each channel by a
/// t-test on the replicates' means. Each block size has an equal share of alpha, each test of a size an equal
/// share of that. Films of one seed and the same samples share most of their noise: the differences of their
/// replicates are tested. Else the films are independent (Welch 1947: unequal variances; the number of
/// replicates may differ). Differences below 2^-17 of the mean, which the order of float operations can make,
/// are never counted. Throws InputError unless both films show one window and keep at least two replicates.
NoiseTest test_noise(const Film& film, const Film& reference, double alpha);

/// The same of two images with `noise`, taken for independent, whose errors add up over a block as those of
/// uncorrelated pixels. The degrees of freedom of a block's variance are those of Satterthwaite (1946); where
/// they are infinite, t is normal. Throws InputError where an image has no noise estimate, a variance is
/// negative or not finite, or sizes differ.
NoiseTest test_noise(const ImageFile& image, const ImageFile& reference, double alpha);

/// The probability that Student's t with `freedom` degrees of freedom (normal where infinite) lies beyond
/// +-t.
double t_test_p_value(double t, double freedom);

}  // namespace castray
