#pragma once

#include <cstddef>
#include <set>

#include "castray/scene.h"

namespace castray {

/// The census of a scene: which features it really uses, by the triangles that are there.
struct SceneNeeds {
  std::size_t triangles = 0, lights = 0;  ///< lights: emitting triangles
  std::size_t instances = 0;              ///< that share the triangles of their object
  bool textures = false;                  ///< or lobes that lie by texture coordinates
  bool smooth_normals = false;
  std::set<MaterialType> types;  ///< of materials
  bool specular = false;         ///< a perfectly smooth mirror or glass
  bool glossy = false;        ///< a surface that reflects other than by Lambert's model, and not as a mirror
  bool narrow_coats = false;  ///< a narrow lobe over a base whose light pixels share, as plastic has
  bool bent_normals = false;  ///< by normal or bump maps
  bool coverage = false;      ///< surfaces of which only a share is there
  bool glass_shares = false;  ///< surfaces that are glass at some points
  bool environment = false;
  std::size_t delta_lights = 0;
};

SceneNeeds needs_of(const Scene& scene);

}  // namespace castray
