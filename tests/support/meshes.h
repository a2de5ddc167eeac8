#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "accel/ray.h"
#include "generate/shapes.h"

namespace castray {

/// A mesh that owns its arrays.
struct TestMesh {
  std::vector<Vec3f> positions;
  std::vector<Index3> triangles;

  TestMesh() = default;
  /// The shape times `scale`, moved by `offset`, each coordinate rounded to float.
  explicit TestMesh(const Shape& shape, double scale = 1, const Vec3d& offset = {})
      : triangles(shape.triangles) {
    for (const Vec3d& p : shape.positions) positions.emplace_back(p * scale + offset);
  }

  MeshView view() const {
    return {positions.data(), triangles.data(), static_cast<std::uint32_t>(triangles.size())};
  }

  void add(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2});
  }
};

/// A closed sphere of rings pulled towards one pole: nearly all of its triangles are slivers.
inline Shape sliver_sphere(std::uint32_t around, std::uint32_t rings) {
  Shape shape;
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    const double z = 1 - 2 * std::pow((ring + 1.0) / (rings + 1.0), 4), r = std::sqrt(1 - z * z);
    for (std::uint32_t i = 0; i < around; ++i) {
      const double phi = 2 * std::numbers::pi * i / around;
      shape.positions.push_back({r * std::cos(phi), r * std::sin(phi), z});
    }
  }
  const std::uint32_t top = around * rings, bottom = top + 1;
  shape.positions.insert(shape.positions.end(), {{0, 0, 1}, {0, 0, -1}});
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t next = (i + 1) % around, last = around * (rings - 1);
    shape.triangles.push_back({top, i, next});
    shape.triangles.push_back({bottom, last + next, last + i});
    for (std::uint32_t a = 0; a < last; a += around) {
      shape.triangles.push_back({a + i, a + around + i, a + around + next});
      shape.triangles.push_back({a + i, a + around + next, a + next});
    }
  }
  return shape;
}

/// Sheets of two triangles, again and again in the same four planes.
inline TestMesh coplanar_stack(int copies) {
  TestMesh mesh;
  for (int i = 0; i < copies; ++i) {
    const float z = static_cast<float>(i % 4) / 4;
    mesh.add({-1, -1, z}, {1, -1, z}, {1, 1, z});
    mesh.add({-1, -1, z}, {1, 1, z}, {-1, 1, z});
  }
  return mesh;
}

/// The meshes that accelerators are tested on, by name, each of about `triangles`.
inline std::vector<std::pair<std::string, TestMesh>> standard_meshes(std::uint32_t triangles) {
  std::vector<std::pair<std::string, TestMesh>> meshes;
  for (const char* name : {"icosphere", "blob", "torus_knot", "terrain", "hair", "soup"}) {
    meshes.emplace_back(name, TestMesh(make_shape(name, triangles, 1)));
  }
  meshes.emplace_back("sliver sphere", sliver_sphere(triangles / 60, 30));
  meshes.emplace_back("coplanar stack", coplanar_stack(static_cast<int>(triangles / 2)));
  return meshes;
}

}  // namespace castray
