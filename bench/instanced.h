#pragma once

#include <vector>

#include "castray/scene.h"
#include "geometry/ray.h"
#include "scene/transform.h"

namespace castray {

/// Transforms of all kinds: turned, far smaller, stretched, mirrored, and stretched and turned again and
/// again.
std::vector<Transform> kinds_of_places();

/// A mesh alone, its coordinates as they are.
Scene scene_of(const MeshView& mesh);

/// A mesh, all its coordinates in [-1,1], at each of some places, as instances.
Scene scene_of(const MeshView& mesh, const std::vector<Transform>& places);

/// The same scene with all that does not emit as instances, one for each transform: that maps the instance's
/// space to the scene's but for its size and middle.
Scene as_instances(const Scene& flat, const std::vector<Transform>& places);

}  // namespace castray
