#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "castray/scene.h"
#include "castray/vec.h"

namespace castray {

/// Why a triangle cannot be rendered.
enum class TriangleFault : std::uint8_t { not_finite, no_area };
inline constexpr std::size_t triangle_faults = 2;

/// Whether all coordinates are in `coordinate_range`.
bool is_in_reach(const Vec3d& p);

/// The fault of the triangle of these corners: one of them is out of reach, or all lie on a line.
std::optional<TriangleFault> fault_of(const Vec3d& a, const Vec3d& b, const Vec3d& c);

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
  /// By TriangleFault, where the file has the first triangle of it; without a file where it has none.
  std::array<SourcePlace, triangle_faults> first_faults;
};

/// Adds the triangles of `more` behind those of `all`. No index may grow beyond 32 bits.
void append(Mesh& all, Mesh&& more);

/// Leaves only the triangles that are marked.
void keep_triangles(Mesh& mesh, const std::vector<bool>& keep);

/// Leaves only the positions that triangles use.
template <class Point>
void drop_unused(std::vector<Point>& positions, std::vector<Index3>& triangles) {
  constexpr std::uint32_t used = 0;
  std::vector<std::uint32_t> renumbered(positions.size(), Scene::no_index);
  for (const Index3& corners : triangles)
    for (std::uint32_t i : corners) renumbered[i] = used;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < renumbered.size(); ++i) {
    if (renumbered[i] == Scene::no_index) continue;
    positions[count] = positions[i];
    renumbered[i] = count++;
  }
  if (count == renumbered.size()) return;
  positions.resize(count);
  for (Index3& corners : triangles)
    for (std::uint32_t& i : corners) i = renumbered[i];
}

inline constexpr Index3 no_indices{Scene::no_index, Scene::no_index, Scene::no_index};

}  // namespace castray
