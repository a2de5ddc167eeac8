#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <utility>

#include "generate/shapes.h"

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
  for (const char* name : {"icosphere", "blob", "torus_knot", "terrain", "hair", "soup", "sticks"})
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

TEST_CASE("the same seed gives the same shape, another one another") {
  CHECK(make_shape("blob", 500, 1).positions == make_shape("blob", 500, 1).positions);
  CHECK(make_shape("blob", 500, 1).positions != make_shape("blob", 500, 2).positions);
}
