#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "castray/scene.h"
#include "castray/vec.h"

namespace castray {

/// Triangles as the input gives them, in double, before the scene's place and size are known.
struct Mesh {
  std::vector<Vec3d> positions;
  std::vector<Index3> triangles;
  std::vector<std::uint16_t> triangle_material;  ///< per triangle, into Scene::materials
  std::vector<SceneObject> objects;              ///< as the file names them; may be empty
  std::vector<Vec3f> normals;
  std::vector<Index3> triangle_normals;  ///< empty, or per triangle; Scene::no_index where it has none
  std::vector<std::array<float, 2>> uvs;
  std::vector<Index3> triangle_uvs;     ///< empty, or per triangle; Scene::no_index where it has none
  std::vector<Vec3f> colors;            ///< linear RGB of vertices
  std::vector<Index3> triangle_colors;  ///< empty, or per triangle; Scene::no_index where it has none
};

/// Adds the triangles of `more` behind those of `all`. No index may grow beyond 32 bits.
void append(Mesh& all, Mesh&& more);

inline constexpr Index3 no_indices{Scene::no_index, Scene::no_index, Scene::no_index};

}  // namespace castray
