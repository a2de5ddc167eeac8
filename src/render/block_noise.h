#pragma once

#include <vector>

#include "castray/film.h"
#include "plan/sample_map.h"

namespace castray {

/// The variance of each block of an image, as relMSE.
class BlockNoise {
 public:
  /// From two independent films a and b of the image: per pixel and channel, (a-b)^2 estimates the variance.
  /// Normalised by a b, not a^2, so that an outlier does not shrink its own error. The films must be
  /// independent of each other; samples within one may be correlated, as points of a sequence and pixels that
  /// share paths are.
  ///
  /// The error of n samples is taken to be that of one over n. For a sequence this overestimates it.
  BlockNoise(const Film& a, const Film& b, const SampleMap& blocks);

  /// The expected relMSE of an image with the samples of the map, or with those that the film has.
  double expected_error(const SampleMap& map) const;
  double expected_error(const Film& film) const;

  /// The fewest samples per pixel, at most `most`, with an expected relMSE of `target`: in proportion to the
  /// square root of a block's noise (Neyman 1934). `most` everywhere if that is not enough.
  SampleMap plan(double target, std::uint64_t most) const;

 private:
  void raise_the_least();
  /// The mean over the image's pixels of value(i), i the pixel's block.
  template <class Value>
  double mean(Value value) const;
  SampleMap planned(double samples_per_noise, std::uint64_t most) const;

  SampleMap blocks_;
  std::vector<double> noise_;  ///< by block: relMSE of one sample a pixel
};

}  // namespace castray
