#pragma once

#include <vector>

#include "castray/scene.h"
#include "lights/light_records.h"

namespace castray {

/// The images of lights in the flat mirrors of a scene, and in flat polished metal: where to look from a
/// surface for what these reflect. At most most_mirrored_lights, those that are likely to bring most.
/// Coplanar triangles of a material are one mirror; mirrors that are much smaller than a light are left out,
/// as they show a small part of it only.
std::vector<MirroredLight> mirrored_lights(const Scene& scene, const std::vector<KernelLight>& lights);

}  // namespace castray
