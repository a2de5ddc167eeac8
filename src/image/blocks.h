#pragma once

#include <vector>

#include "castray/film.h"

namespace castray {

/// The blocks of `size` x `size` noise blocks that cover `all`, cut at its border.
std::vector<Film::Blocks> groups_of(const Film::Blocks& all, int size);

/// How many times blocks can be doubled in size, from 1, until one covers `all`; at least 1.
int count_sizes(const Film::Blocks& all);

/// A mean, the variance of its error, and the degrees of freedom of that variance.
struct Estimate {
  double mean = 0, variance = 0, freedom = 1;
};

/// The mean of independent values, at least two.
Estimate estimate(const std::vector<double>& values);

/// One channel of replicate means.
std::vector<double> channel_of(const std::vector<Vec3d>& means, int channel);

}  // namespace castray
