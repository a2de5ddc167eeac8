#include "geometry/bvh.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <functional>

#include "geometry/bvh_build.h"
#include "geometry/list.h"
#include "stress_checks.h"

using namespace castray;

namespace {

template <class T>
bool same(const Hit<T>& a, const Hit<T>& b) {
  return a.triangle == b.triangle && (!a.found() || (a.t == b.t && a.b1 == b.b1 && a.b2 == b.b2));
}

/// The number of rays on which tree and list disagree, in anything.
template <class T>
int disagreements(const FloatMesh& mesh, std::size_t rays, std::uint32_t seed) {
  const Bvh bvh = Bvh::build(mesh.view(), 2);
  const TriangleList list(mesh.view());
  int wrong = 0;
  for (const Ray<float>& r : rays_around(mesh, rays, seed)) {
    const Ray<T> ray{Vec3<T>(r.origin), Vec3<T>(r.direction), r.t_max};
    const Hit<T> expected = list.closest(ray);
    wrong += !same(bvh.closest(ray), expected) || bvh.occluded(ray) != expected.found();
  }
  return wrong;
}

void check_structure(const BinaryTree& tree, const MeshView& mesh, std::uint32_t max_leaf) {
  std::vector<int> seen(mesh.count);
  int deepest = 0;
  const std::function<void(const BvhNode&, int)> visit = [&](const BvhNode& node, int depth) {
    if (!node.is_leaf()) {
      for (const BvhNode& child : tree.pairs[node.first].child) visit(child, depth + 1);
      return;
    }
    deepest = std::max(deepest, depth);
    REQUIRE(node.count <= max_leaf);
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      ++seen[tree.primitives[i]];
      for (const std::uint32_t v : mesh.triangles[tree.primitives[i]]) {
        for (int axis = 0; axis < 3; ++axis) {
          REQUIRE(mesh.positions[v][axis] >= node.lower[axis]);
          REQUIRE(mesh.positions[v][axis] <= node.upper[axis]);
        }
      }
    }
  };
  visit(tree.root, 0);
  CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
  CHECK(deepest == tree.depth);
  CHECK(tree.depth <= max_bvh_depth);
}

}  // namespace

TEST_CASE("BVH and list find the same hits") {
  for (const auto& [name, mesh] : standard_meshes(1200)) {
    INFO(name);
    CHECK(disagreements<float>(mesh, 3000, 7) == 0);
    CHECK(disagreements<double>(mesh, 1000, 8) == 0);
  }
}

TEST_CASE("BVH and list find the same hits on a million rays", "[long]") {
  for (const auto& [name, mesh] : standard_meshes(1200)) {
    INFO(name);
    CHECK(disagreements<float>(mesh, 130000, 9) == 0);
    CHECK(disagreements<double>(mesh, 20000, 10) == 0);
  }
}

TEST_CASE("BVH over no triangle and one") {
  const Ray<float> ray{{0.2f, 0.2f, -1}, {0, 0, 1}};
  FloatMesh mesh;
  const Bvh none = Bvh::build(mesh.view(), 2);
  CHECK_FALSE(none.closest(ray).found());
  CHECK_FALSE(none.occluded(ray));
  CHECK(none.stats().nodes == 0);

  mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Bvh one = Bvh::build(mesh.view(), 2);
  const Hit<float> hit = one.closest(ray);
  CHECK(hit.triangle == 0);
  CHECK(hit.t == 1);
  CHECK(hit.b1 == Approx(0.2));
  CHECK(hit.b2 == Approx(0.2));
  CHECK(one.stats().nodes == 1);
  CHECK(one.stats().depth == 0);
}

TEST_CASE("BVH of awkward meshes is sound") {
  FloatMesh line, same_centre, exponential, huge;
  for (int i = 0; i < 1000; ++i) {
    const float x = static_cast<float>(i), e = std::ldexp(1.0f, i % 250 - 125);
    line.add({x, 0, 0}, {x + 1, 0, 0}, {x + 0.5f, 0, 0});
    same_centre.add({-1 - x, 0, 1}, {1 + x, -2, 1}, {0, 2, 1});
    exponential.add({e, 0, 0}, {1.25f * e, e, 0}, {1.5f * e, 0, e});
    huge.add({1e38f * std::sin(x), 0, 0}, {0, 3e38f * std::cos(x), 0}, {-3e38f, 0, 2e38f});
  }
  for (const FloatMesh& mesh :
       {line, same_centre, exponential, huge, coplanar_stack(3000), place(soup(20000, 3))}) {
    const BinaryTree tree = build_binary_tree(mesh.view(), {.threads = 2});
    check_structure(tree, mesh.view(), 8);
  }
}

TEST_CASE("BVH does not depend on the number of threads") {
  const FloatMesh mesh = place(soup(200000, 4));
  const BinaryTree one = build_binary_tree(mesh.view(), {.threads = 1});
  const BinaryTree two = build_binary_tree(mesh.view(), {.threads = 2});
  const BinaryTree five = build_binary_tree(mesh.view(), {.threads = 5});
  for (const BinaryTree* other : {&two, &five}) {
    CHECK(other->primitives == one.primitives);
    REQUIRE(other->pairs.size() == one.pairs.size());
    CHECK(std::memcmp(other->pairs.data(), one.pairs.data(), one.pairs.size() * sizeof(BvhPair)) == 0);
    CHECK(other->sah_cost == one.sah_cost);
  }
}

TEST_CASE("Rays that are not finite, or too short, hit nothing") {
  const FloatMesh mesh = place(icosphere(4));
  const Bvh bvh = Bvh::build(mesh.view(), 2);
  const TriangleList list(mesh.view());
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {inf, -inf, nan}) {
    for (int axis = 0; axis < 3; ++axis) {
      Ray<float> direction{{0, 0, 0}, {1, 1, 1}}, origin = direction;
      direction.direction[axis] = bad;
      origin.origin[axis] = bad;
      for (const Ray<float>& ray : {direction, origin}) {
        CHECK_FALSE(bvh.closest(ray).found());
        CHECK_FALSE(list.closest(ray).found());
        CHECK_FALSE(bvh.occluded(ray));
      }
    }
  }
  CHECK_FALSE(bvh.closest(Ray<float>{{0, 0, 0}, {0, 0, 0}}).found());
  CHECK_FALSE(bvh.closest(Ray<float>{{0, 0, 0}, {0, 1, 0}, nan}).found());
  CHECK_FALSE(bvh.closest(Ray<float>{{0, 0, 0}, {0, 1, 0}, 0}).found());
  CHECK(bvh.closest(Ray<float>{{0, 0, 0}, {0, 1, -0.0f}}).found());
  CHECK(bvh.closest(Ray<float>{{0, 0, 0}, {-0.0f, -1, 0}}).found());
  CHECK(bvh.closest(Ray<float>{{0, 0, 0}, {1e-40f, 1e-15f, -1e-42f}}).found());
}
