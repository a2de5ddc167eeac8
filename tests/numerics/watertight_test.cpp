#include <catch2/catch.hpp>
#include <random>

#include "accel/bvh.h"
#include "accel/list.h"
#include "meshes.h"

using namespace castray;

namespace {

/// Rays from inside a closed mesh exactly at its vertices, at points of its edges, and a last bit beside
/// them: how many hit nothing.
template <class T, class Accelerator>
int leaks(const Accelerator& accel, const TestMesh& mesh, const Vec3d& inside, double scale, int rays,
          std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  int leaked = 0;
  for (int i = 0; i < rays; ++i) {
    const Index3& triangle = mesh.triangles[random() % mesh.triangles.size()];
    const Vec3<T> a(mesh.positions[triangle[0]]), b(mesh.positions[triangle[1]]);
    const double x = number(random), y = number(random), z = number(random);
    const Vec3<T> origin(inside + 0.3 * scale * Vec3d(x, y, z));
    Vec3<T> target = a;
    if (i % 3 == 1) target = a + T(std::abs(number(random))) * (b - a);
    if (i % 3 == 2) {
      for (int axis = 0; axis < 3; ++axis) target[axis] = std::nextafter(target[axis], T(number(random)));
    }
    const Ray<T> ray{origin, target - origin};
    leaked += !accel.closest(ray).found();
  }
  return leaked;
}

template <class T>
void check_closed(const Shape& shape, int rays) {
  for (const double scale : {1e-6, 1e-4, 1.0, 1e4, 1e6}) {
    for (const Vec3d& place : {Vec3d(0, 0, 0), Vec3d(1000, -300, 50), Vec3d(1e6, 1e6, -1e6)}) {
      const TestMesh moved(shape, scale, scale * place);
      const Bvh bvh = Bvh::build(moved.view(), 2);
      INFO("scale " << scale << ", place " << place.x);
      CHECK(leaks<T>(bvh, moved, scale * place, scale, rays, 5) == 0);
    }
  }
}

}  // namespace

TEST_CASE("No ray leaves a closed sphere") {
  check_closed<float>(icosphere(32), 6000);
  check_closed<double>(icosphere(32), 1000);
}

TEST_CASE("No ray leaves a closed sphere of slivers") { check_closed<float>(sliver_sphere(200, 50), 6000); }

TEST_CASE("No ray leaves a closed sphere, by the list") {
  const TestMesh mesh(icosphere(4));
  CHECK(leaks<float>(TriangleList(mesh.view()), mesh, {}, 1, 30000, 6) == 0);
}

TEST_CASE("No ray leaves closed spheres, ten million rays", "[long]") {
  check_closed<float>(icosphere(32), 500000);
  check_closed<float>(sliver_sphere(200, 50), 200000);
}
