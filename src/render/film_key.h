#pragma once

#include <string>

#include "castray/render.h"

namespace castray {

/// All that a film's samples depend on besides their index, readable: the scene with a hash of its contents,
/// image size, seed and the options that change the estimator. Not threads, crop, or accelerator.
std::string film_key(const Scene& scene, const RenderOptions& options);

}  // namespace castray
