#pragma once

#include <cstddef>
#include <set>

#include "castray/scene.h"

namespace castray {

/// The census of a scene: which features it really uses, by the triangles that are there.
struct SceneNeeds {
  std::size_t triangles = 0, lights = 0;  ///< lights: emitting triangles
  bool textures = false, smooth_normals = false;
  std::set<MaterialType> types;  ///< of materials
  bool specular = false;         ///< a perfectly smooth mirror or glass
  bool bent_normals = false;     ///< by normal or bump maps
  bool coverage = false;         ///< surfaces of which only a share is there
  bool environment = false;
};

SceneNeeds needs_of(const Scene& scene);

}  // namespace castray
