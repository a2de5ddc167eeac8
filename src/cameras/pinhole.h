#pragma once

#include "cameras/camera_records.h"
#include "castray/scene.h"

namespace castray {

/// The camera as kernels read it, for an image of this size.
KernelCamera kernel_camera(const Camera& camera, int width, int height);

}  // namespace castray
