#pragma once

#include <cstdint>
#include <string>

#include "plan/job.h"

namespace castray {

/// All that a film's samples depend on besides their index, readable: the scene with a hash of its contents,
/// image size, seed and the options that change the estimator, each as NAME=VALUE of a flag of the command
/// line. Not threads, crop, or accelerator.
std::string film_key(const SceneFacts& scene, const Job& job);

/// A hash of all of a scene that samples depend on.
std::uint64_t scene_hash(const Scene& scene);

}  // namespace castray
