#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <utility>

#include "generate/leaves.h"

using namespace castray;

namespace {

/// Every edge is there once in each direction: closed, and wound the same way all over.
bool is_closed(const Shape& shape) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const Index3& t : shape.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  for (const auto& [edge, sum] : balance)
    if (sum != 0) return false;
  return true;
}

double volume(const Shape& shape) {
  double sum = 0;
  for (const Index3& t : shape.triangles)
    sum += dot(shape.positions[t[0]], cross(shape.positions[t[1]], shape.positions[t[2]])) / 6;
  return sum;
}

double greatest_coordinate(const Shape& shape) {
  double greatest = 0;
  for (const Vec3d& p : shape.positions)
    for (int i = 0; i < 3; ++i) greatest = std::max(greatest, std::abs(p[i]));
  return greatest;
}

}  // namespace

TEST_CASE("generated shapes have the asked-for size") {
  CHECK(make_shape("icosphere", 20000, 1).triangles.size() == 20480);
  CHECK(make_shape("blob", 5000, 1).triangles.size() == 5120);
  CHECK(make_shape("terrain", 12345, 1).triangles.size() == 12345);
  CHECK(make_shape("hair", 5001, 1).triangles.size() == 5001);
  CHECK(make_shape("soup", 777, 1).triangles.size() == 777);
  for (const char* name : {"icosphere", "blob", "torus_knot", "terrain", "hair", "soup", "sticks",
                           "masked_leaves", "cut_leaves"})
    CHECK(greatest_coordinate(make_shape(name, 3000, 1)) <= 1);
}

TEST_CASE("generated solids are closed and face outwards") {
  for (const char* name : {"icosphere", "blob", "torus_knot"}) {
    const Shape shape = make_shape(name, 4000, 3);
    INFO(name);
    CHECK(is_closed(shape));
    CHECK(volume(shape) > 0.1);
  }
  CHECK(volume(icosphere(40)) == Approx(4.18879).epsilon(3e-3));
}

TEST_CASE("a smooth icosphere is an icosphere with the sphere's normals") {
  const Shape ball = smooth_icosphere(8);
  CHECK(ball.positions == icosphere(8).positions);
  REQUIRE(ball.normals.size() == ball.positions.size());
  for (std::size_t i = 0; i < ball.normals.size(); ++i)
    CHECK(dot(ball.normals[i], ball.positions[i]) == Approx(1));
}

TEST_CASE("leaves behind a mask are those that are cut out") {
  const Shape masked = masked_leaves(50, 2), cut = cut_leaves(50, 2);
  CHECK(masked.triangles.size() == 100);
  CHECK(masked.uvs.size() == masked.positions.size());
  CHECK(cut.triangles.size() == 50 * triangles_of_cut_leaf);
  const auto area = [](const Shape& shape) {
    double sum = 0;
    for (const Index3& t : shape.triangles) {
      const Vec3d &a = shape.positions[t[0]], &b = shape.positions[t[1]], &c = shape.positions[t[2]];
      sum += length(cross(b - a, c - a)) / 2;
    }
    return sum;
  };
  const Image mask = leaf_mask(64);
  double inside = 0;
  for (const Vec3f& texel : mask.pixels) inside += texel.x / static_cast<double>(mask.pixels.size());
  CHECK(area(cut) == Approx(inside * area(masked)).epsilon(2e-3));
  CHECK(mask.at(32, 32).x == 1);
  CHECK(mask.at(0, 0).x == 0);
  // Of each leaf, the middle of the square is inside the outline, and both face the same side.
  for (std::uint32_t i = 0; i < 50; ++i) {
    const auto normal = [](const Shape& shape, std::size_t t) {
      const Index3& c = shape.triangles[t];
      return cross(shape.positions[c[1]] - shape.positions[c[0]],
                   shape.positions[c[2]] - shape.positions[c[0]]);
    };
    CHECK(dot(normal(masked, 2 * i), normal(cut, std::size_t{triangles_of_cut_leaf} * i)) > 0);
  }
}

TEST_CASE("the same seed gives the same shape, another one another") {
  CHECK(make_shape("blob", 500, 1).positions == make_shape("blob", 500, 1).positions);
  CHECK(make_shape("blob", 500, 1).positions != make_shape("blob", 500, 2).positions);
}
