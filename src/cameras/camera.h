#pragma once

#include "cameras/camera_records.h"
#include "castray/camera.h"

namespace castray {

/// The camera as kernels read it, for an image of this size.
KernelCamera kernel_camera(const Camera& camera, int width, int height);

/// How far from the origin rays of this image start at most.
double farthest_origin(const Camera& camera, int width, int height);

}  // namespace castray
