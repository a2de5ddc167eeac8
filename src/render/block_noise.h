#pragma once

#include <vector>

#include "castray/film.h"
#include "image/convolve.h"
#include "plan/sample_map.h"

namespace castray {

/// The variance of one sample of each pixel, as relMSE.
class PixelNoise {
 public:
  /// From two independent films a and b of the image: per pixel and channel, (a-b)^2 of their images, which
  /// are reconstructed if films keep differences, estimates the variance. The films must be independent of
  /// each other; samples within one may be correlated, as points of a sequence and pixels that share paths
  /// are. A pixel that one of them lacks has no noise. `threads`: as for `image_of`.
  PixelNoise(const Film& a, const Film& b, int threads = 0);

  /// Of pixel (x,y) of the full image.
  double at(int x, int y) const { return plane_.at(x - window_.x0, y - window_.y0); }
  /// The expected relMSE of a film of the same window, the error of n samples that of one over n.
  double expected_error(const Film& film) const;

 private:
  Window window_;
  Plane plane_;
};

/// BlockNoise's fall from one sample to two: of independent films a and b of two samples, whose first are
/// `first_a` and `first_b`. Both samples of a film count as one, so that a rare bright one is no fall.
double fall_from_first(const Film& a, const Film& b, const Film& first_a, const Film& first_b);

/// The variance of one sample in each block of an image, as relMSE.
class BlockNoise {
 public:
  /// `blocks`: the samples of each of the films that told the noise.
  BlockNoise(const PixelNoise& pixels, const SampleMap& blocks);

  /// As a sequence's error falls faster than 1/n, so does the noise of one of n samples, as n^-fall: the fall
  /// from a film of fewer samples to this one's, less what may be chance; 0 to 1/2, and that which was set
  /// for the shorter film between films of about as many samples.
  double fall_from(const BlockNoise& shorter) const;
  void set_fall(double fall) { fall_ = fall; }

  /// The expected relMSE of an image with the samples of the map, in two halves with sequences of their own.
  double expected_error(const SampleMap& map) const;

  /// The fewest samples per pixel, from `least` to `most`, with an expected relMSE of `target`: in proportion
  /// to the square root of a block's noise (Neyman 1934). `most` everywhere if that is not enough.
  SampleMap plan(double target, std::uint64_t least, std::uint64_t most) const;

 private:
  void raise_the_least();
  /// The mean over the image's pixels of value(i), i the pixel's block.
  template <class Value>
  double mean(Value value) const;
  SampleMap planned(double samples_per_noise, std::uint64_t least, std::uint64_t most) const;

  SampleMap blocks_;
  std::vector<double> noise_;  ///< by block: relMSE of one sample a pixel, among as many as the film has
  double fall_ = 0;
};

}  // namespace castray
