#pragma once

#include <string>

#include "castray/render.h"
#include "castray/scene.h"

namespace castray::cli {

/// Whether every pixel of the film is exactly black.
bool is_black(const Film& film);

/// Why an image of `scene`, in which something emits, is black, by a few rays from its camera: in words for
/// the user, with what to do.
std::string why_black(const Scene& scene, const RenderOptions& options);

}  // namespace castray::cli
