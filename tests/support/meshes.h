#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "accel/ray.h"

namespace castray {

/// A mesh that owns its arrays.
struct TestMesh {
  std::vector<Vec3f> positions;
  std::vector<Index3> triangles;

  MeshView view() const {
    return {positions.data(), triangles.data(), static_cast<std::uint32_t>(triangles.size())};
  }

  void add(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2});
  }

  /// The mesh times `scale`, moved by `offset`, each coordinate rounded to float.
  TestMesh placed(double scale, const Vec3d& offset) const {
    TestMesh moved = *this;
    for (Vec3f& p : moved.positions) p = Vec3f(Vec3d(p) * scale + offset);
    return moved;
  }
};

/// A grid of u x v vertices, closed in the directions where it says so.
inline TestMesh grid_mesh(std::uint32_t nu, std::uint32_t nv, bool close_u, bool close_v,
                          const std::function<Vec3f(std::uint32_t, std::uint32_t)>& point) {
  TestMesh mesh;
  for (std::uint32_t u = 0; u < nu; ++u) {
    for (std::uint32_t v = 0; v < nv; ++v) mesh.positions.push_back(point(u, v));
  }
  for (std::uint32_t u = 0; u + 1 < nu + (close_u ? 1u : 0u); ++u) {
    for (std::uint32_t v = 0; v + 1 < nv + (close_v ? 1u : 0u); ++v) {
      const std::uint32_t u1 = (u + 1) % nu, v1 = (v + 1) % nv;
      const std::uint32_t a = u * nv + v, b = u1 * nv + v, c = u1 * nv + v1, d = u * nv + v1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

/// A closed unit sphere of 20 * 4^levels triangles.
inline TestMesh icosphere(int levels) {
  const float g = std::numbers::phi_v<float>;
  TestMesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3f& p : mesh.positions) p = normalize(p);
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), 0u);
      if (is_new) {
        entry->second = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(normalize(mesh.positions[a] + mesh.positions[b]));
      }
      return entry->second;
    };
    std::vector<Index3> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(),
                   {Index3{a, ab, ca}, Index3{b, bc, ab}, Index3{c, ca, bc}, Index3{ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// A closed tube of `radius` along the (2,3) torus knot of size 1.
inline TestMesh torus_knot(std::uint32_t along, std::uint32_t around, double radius) {
  const auto centre = [](double s) {
    const double r = (2 + std::cos(3 * s)) / 3;
    return Vec3d(r * std::cos(2 * s), r * std::sin(2 * s), std::sin(3 * s) / 3);
  };
  constexpr double turn = 2 * std::numbers::pi;
  return grid_mesh(along, around, true, true, [&](std::uint32_t u, std::uint32_t v) {
    const double s = turn * u / along, angle = turn * v / around;
    const Vec3d forward = normalize(centre(s + 1e-4) - centre(s - 1e-4));
    const Vec3d side = normalize(cross(forward, centre(s)));
    return Vec3f(centre(s) + radius * (std::cos(angle) * side + std::sin(angle) * cross(side, forward)));
  });
}

/// A closed sphere of rings pulled together: nearly all of its triangles are slivers.
inline TestMesh sliver_sphere(std::uint32_t around, std::uint32_t rings) {
  TestMesh mesh = grid_mesh(around, rings, true, false, [&](std::uint32_t u, std::uint32_t v) {
    const double squeeze = std::pow((v + 1.0) / (rings + 1.0), 4), phi = 2 * std::numbers::pi * u / around;
    const double z = 1 - 2 * squeeze, r = std::sqrt(1 - z * z);
    return Vec3f(Vec3d(r * std::cos(phi), r * std::sin(phi), z));
  });
  const auto top = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 1}, {0, 0, -1}});
  for (std::uint32_t u = 0; u < around; ++u) {
    const std::uint32_t next = (u + 1) % around;
    mesh.triangles.push_back({top, next * rings, u * rings});
    mesh.triangles.push_back({top + 1, u * rings + rings - 1, next * rings + rings - 1});
  }
  return mesh;
}

inline TestMesh terrain(std::uint32_t n) {
  return grid_mesh(n, n, false, false, [n](std::uint32_t u, std::uint32_t v) {
    const float x = 2 * static_cast<float>(u) / static_cast<float>(n - 1) - 1;
    const float y = 2 * static_cast<float>(v) / static_cast<float>(n - 1) - 1;
    return Vec3f(x, y, 0.1f * std::sin(9 * x) * std::cos(7 * y) + 0.02f * std::sin(71 * x + 31 * y));
  });
}

/// `n` triangles of about `size` strewn in the unit cube; `aspect` above 1 makes slivers.
inline TestMesh soup(std::uint32_t n, float size, float aspect, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(-1, 1);
  const auto point = [&] {
    const float x = number(random), y = number(random), z = number(random);
    return Vec3f(x, y, z);
  };
  TestMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3f a = point(), along = size * point(), aside = (size / aspect) * point();
    mesh.add(a, a + along, a + aside);
  }
  return mesh;
}

/// Sheets of the same two triangles, again and again in the same planes.
inline TestMesh coplanar_stack(int copies) {
  TestMesh mesh;
  for (int i = 0; i < copies; ++i) {
    const float z = static_cast<float>(i % 4) / 4;
    mesh.add({-1, -1, z}, {1, -1, z}, {1, 1, z});
    mesh.add({-1, -1, z}, {1, 1, z}, {-1, 1, z});
  }
  return mesh;
}

/// The meshes that accelerators are tested on, by name.
inline std::vector<std::pair<std::string, TestMesh>> standard_meshes() {
  return {{"icosphere", icosphere(3)},
          {"torus knot", torus_knot(120, 10, 0.1)},
          {"sliver sphere", sliver_sphere(40, 30)},
          {"terrain", terrain(32)},
          {"soup", soup(1500, 0.2f, 1, 1)},
          {"slivers", soup(1500, 0.7f, 1000, 2)},
          {"coplanar stack", coplanar_stack(100)}};
}

}  // namespace castray
