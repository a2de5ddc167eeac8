#pragma once

#include <vector>

#include "castray/film.h"
#include "plan/sample_map.h"

namespace castray {

/// How noisy each block of an image is.
class BlockNoise {
 public:
  /// From two independent films of the image. Per pixel and channel, (a-b)^2 tells the variance of a sample.
  /// The radiance's square that it is held to is a b, lest a bright outlier excuse itself. Independence
  /// makes this right where samples of one film are correlated: within one, as points of a sequence are, and
  /// between pixels, as those that share paths are.
  ///
  /// The error of n samples is taken to be that of one over n. Sequences do better: then errors are
  /// overestimated.
  BlockNoise(const Film& a, const Film& b, const SampleMap& blocks);

  /// The relMSE to be expected where pixels get the samples of the map; of a film with these samples.
  double expected_error(const SampleMap& map) const;
  double expected_error(const Film& film) const;

  /// The fewest samples per pixel, at most `most`, that an error of `target` is expected of: in proportion to
  /// the square root of a block's noise (Neyman 1934). `most` everywhere if they do not suffice.
  SampleMap plan(double target, std::uint64_t most) const;

 private:
  void raise_the_least();
  /// Over the image's pixels, of what each block i has.
  template <class Value>
  double mean(Value value) const;
  SampleMap planned(double samples_per_noise, std::uint64_t most) const;

  SampleMap blocks_;
  std::vector<double> noise_;  ///< by block: relMSE of one sample a pixel
};

}  // namespace castray
