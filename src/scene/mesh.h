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

inline constexpr Index3 no_indices{Scene::no_index, Scene::no_index, Scene::no_index};

}  // namespace castray
