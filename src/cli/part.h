#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "castray/film.h"

namespace castray::cli {

/// One of `count` parts of a render's samples, counted from 0.
struct Part {
  std::uint64_t index = 0, count = 1;
};

/// "I/N", "auto", or "auto/N": then the part is told by the environment of a Slurm array, an indexed
/// Kubernetes job, an array of AWS Batch, or MPI. Throws InputError where it is not.
Part parse_part(const std::string& flag, const std::string& text);

/// The samples of a part: the ranges of all parts are disjoint, as long as one another but for one sample,
/// and make up `all`. Throws InputError if there are fewer samples than parts.
SampleRange range_of(const Part& part, const SampleRange& all);

/// `file` with the number of the part for "{part}", with leading zeros: all are of the same length.
std::filesystem::path name_of(const Part& part, const std::filesystem::path& file);

}  // namespace castray::cli
