#include "geometry/closed_surface.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace castray;

namespace {

const std::vector<Vec3f> corners_of_tetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Index3> tetrahedron = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

struct Found {
  std::ptrdiff_t triangles;
  std::size_t rim;
};

Found find(const std::vector<Vec3f>& positions, const std::vector<Index3>& triangles) {
  const ClosedSurface surface =
      closed_surface({positions.data(), triangles.data(), static_cast<std::uint32_t>(triangles.size())}, 1);
  return {std::ranges::count(surface.has, true), surface.rim.size()};
}

/// A sheet of n x n squares, two triangles each, and its positions.
std::vector<Index3> sheet(std::uint32_t n, std::vector<Vec3f>& positions) {
  std::vector<Index3> triangles;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) positions.push_back({float(x), float(y), 0});
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + n + 1;
      triangles.push_back({a, a + 1, b});
      triangles.push_back({a + 1, b + 1, b});
    }
  return triangles;
}

}  // namespace

TEST_CASE("a closed mesh is a surface without a rim") {
  const auto [triangles, rim] = find(corners_of_tetrahedron, tetrahedron);
  CHECK(triangles == 4);
  CHECK(rim == 0);
}

TEST_CASE("a mesh with a triangle turned round, or without one, is no closed surface") {
  std::vector<Index3> turned = tetrahedron;
  std::swap(turned[0][0], turned[0][1]);
  CHECK(find(corners_of_tetrahedron, turned).triangles == 0);
  CHECK(find(corners_of_tetrahedron, {tetrahedron.begin(), tetrahedron.end() - 1}).triangles == 0);
}

TEST_CASE("a sheet is a surface but for the triangles at its edge, of a small one nothing is") {
  std::vector<Vec3f> positions, few;
  // of 100 x 100 squares: 4 x 100 edges, and 2 corners where one triangle has two of them
  const std::vector<Index3> large = sheet(100, positions);
  CHECK(find(positions, large).triangles == 20000 - 398);
  CHECK(find(positions, large).rim > 4 * 98);
  CHECK(find(positions, large).rim < 8 * 100);
  const std::vector<Index3> small = sheet(4, few);
  CHECK(find(few, small).triangles == 0);
}
