#include "accel/wide_bvh.h"

#include <catch2/catch.hpp>
#include <cstring>

#include "accel/list.h"
#include "kernel_rays.h"
#include "meshes.h"
#include "rays.h"

using namespace castray;

namespace {

bool same(const Hit<float>& a, const Hit<float>& b) {
  return a.triangle == b.triangle && a.t == b.t && a.b1 == b.b1 && a.b2 == b.b2;
}

/// The rays on which a kernel disagrees with the list, in anything.
int disagreements(const KernelApi& kernel, const TestMesh& mesh, int rays, std::uint32_t seed) {
  const WideBvh bvh = WideBvh::build(mesh.view(), 2);
  const TriangleList list(mesh.view());
  RandomRays random(mesh.view(), seed);
  std::vector<Ray<float>> batch;
  for (int i = 0; i < rays; ++i) batch.push_back(random.next());
  const RayArrays arrays(batch);
  const std::vector<Hit<float>> hits = arrays.closest(kernel, bvh.view());
  const std::vector<std::uint8_t> occluded = arrays.occluded(kernel, bvh.view());
  int wrong = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Hit<float> expected = list.closest(batch[i]);
    wrong += !same(hits[i], expected) || (occluded[i] != 0) != expected.found();
  }
  return wrong;
}

void compare_all(int rays, std::uint32_t triangles) {
  for (const KernelApi* kernel : available_kernels()) {
    for (const auto& [name, mesh] : standard_meshes(triangles)) {
      INFO(kernel->name << ", " << name);
      CHECK(disagreements(*kernel, mesh, rays, 11) == 0);
    }
  }
}

}  // namespace

TEST_CASE("every kernel's wide BVH and the list find the same hits") { compare_all(2001, 600); }

TEST_CASE("every kernel's wide BVH and the list find the same hits on a million rays", "[long]") {
  compare_all(35000, 3000);
}

TEST_CASE("wide BVH of few and of identical triangles") {
  for (const KernelApi* kernel : available_kernels()) {
    TestMesh mesh;
    const Ray<float> through{{0.2f, 0.2f, -1}, {0, 0, 1}}, past{{2, 2, -1}, {0, 0, 1}};
    const RayArrays rays(std::vector<Ray<float>>{through, past});
    CHECK_FALSE(rays.closest(*kernel, WideBvh::build(mesh.view(), 2).view())[0].found());
    CHECK(rays.occluded(*kernel, WideBvh::build(mesh.view(), 2).view())[0] == 0);
    for (const std::size_t count : {1, 2, 7, 8, 9, 32, 33, 100}) {
      while (mesh.triangles.size() < count) mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
      const WideBvh bvh = WideBvh::build(mesh.view(), 2);
      const std::vector<Hit<float>> hits = rays.closest(*kernel, bvh.view());
      CHECK(hits[0].triangle == 0);
      CHECK(hits[0].t == 1);
      CHECK_FALSE(hits[1].found());
      CHECK(rays.occluded(*kernel, bvh.view()) == std::vector<std::uint8_t>{1, 0});
    }
  }
}

TEST_CASE("wide BVH does not depend on the number of threads") {
  const TestMesh mesh(soup(100000, 4));
  const WideBvh one = WideBvh::build(mesh.view(), 1), three = WideBvh::build(mesh.view(), 3);
  REQUIRE(one.stats().nodes == three.stats().nodes);
  REQUIRE(one.stats().bytes == three.stats().bytes);
  CHECK(one.view().root == three.view().root);
  CHECK(std::memcmp(one.view().blocks, three.view().blocks, one.stats().bytes) == 0);
}
