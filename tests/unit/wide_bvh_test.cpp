#include "geometry/wide_bvh.h"

#include <catch2/catch.hpp>
#include <cstring>

#include "stress_checks.h"

using namespace castray;

namespace {

void compare_with_list(std::size_t rays, std::uint32_t triangles) {
  for (const auto& [name, mesh] : standard_meshes(triangles)) {
    const auto list = make_tracer("list", mesh.view(), *available_kernels()[0]);
    list->build(1);
    for (const KernelApi* kernel : available_kernels()) {
      const auto wide = make_tracer("wide", mesh.view(), *kernel);
      wide->build(2);
      INFO(wide->name() << ", " << name);
      CHECK(count_disagreements(*wide, *list, rays_around(mesh, rays, 11)) == 0);
    }
  }
}

}  // namespace

TEST_CASE("every kernel's wide BVH and the list find the same hits") { compare_with_list(2001, 600); }

TEST_CASE("every kernel's wide BVH and the list find the same hits on a million rays", "[long]") {
  compare_with_list(35000, 3000);
}

TEST_CASE("boxes cut beforehand change no hit") {
  FloatMesh sticks;
  const FloatMesh ends = place(soup(400, 5));
  for (const Index3& t : ends.triangles) {
    const Vec3f a = ends.positions[t[0]], b = -a;
    sticks.add(a, b, b + 0.02f * (ends.positions[t[1]] - a));
  }
  for (const FloatMesh& mesh : {sticks, place(hair(2000, 1)), coplanar_stack(200)}) {
    const auto list = make_tracer("list", mesh.view(), *available_kernels()[0]);
    const auto best = make_tracer("wide", mesh.view(), *available_kernels().back(), BuildQuality::best);
    list->build(1);
    best->build(2);
    CHECK(count_disagreements(*best, *list, rays_around(mesh, 3000, 12)) == 0);
  }
}

TEST_CASE("wide BVH of few and of identical triangles") {
  for (const KernelApi* kernel : available_kernels()) {
    FloatMesh mesh;
    const auto wide = make_tracer("wide", mesh.view(), *kernel);
    wide->build(1);
    RayArrays rays;
    rays.add({{0.2f, 0.2f, -1}, {0, 0, 1}});
    rays.add({{2, 2, -1}, {0, 0, 1}});
    Hit<float> hits[2];
    std::uint8_t occluded[2];
    wide->closest(rays, 0, 2, hits);
    wide->occluded(rays, 0, 2, occluded);
    CHECK_FALSE(hits[0].found());
    CHECK(occluded[0] == 0);
    for (const std::size_t count : {1, 2, 7, 8, 9, 32, 33, 100}) {
      while (mesh.triangles.size() < count) mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
      const auto filled = make_tracer("wide", mesh.view(), *kernel);
      filled->build(1);
      filled->closest(rays, 0, 2, hits);
      filled->occluded(rays, 0, 2, occluded);
      CHECK(hits[0].triangle == 0);
      CHECK(hits[0].t == 1);
      CHECK(occluded[0] == 1);
      CHECK_FALSE(hits[1].found());
      CHECK(occluded[1] == 0);
    }
  }
}

TEST_CASE("wide BVH does not depend on the number of threads") {
  const FloatMesh mesh = place(soup(100000, 4));
  for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::best}) {
    const WideBvh one = WideBvh::build(mesh.view(), 1, quality),
                  three = WideBvh::build(mesh.view(), 3, quality);
    REQUIRE(one.stats().nodes == three.stats().nodes);
    REQUIRE(one.stats().bytes == three.stats().bytes);
    CHECK(one.view().root == three.view().root);
    CHECK(std::memcmp(one.view().blocks, three.view().blocks, one.stats().bytes) == 0);
  }
}
