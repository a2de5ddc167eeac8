#include <catch2/catch.hpp>

#include "core/error_bounds.h"
#include "core/sequences.h"
#include "core/warp.h"
#include "geometry/list.h"

using namespace castray;

// A ray never meets the triangle it starts from, nor a shadow segment the one it ends on.

namespace {

struct Numbers {
  std::uint64_t i;
  std::uint32_t block = 0;
  std::array<float, 4> next() { return sample_block(SamplerKind::independent, 11, i, block++); }
};

/// Triangles of all shapes: many sizes, slivers, near and far from the origin, often in the plane of an axis.
std::array<Vec3f, 3> awkward_triangle(Numbers& numbers) {
  const auto shape = numbers.next();
  const float size = std::exp2(-20 * shape[0]), thin = shape[1] < 0.3f ? std::exp2(-20 * shape[2]) : 1.f;
  const auto place = numbers.next();
  const float far = place[3] < 0.5f ? 1.f : 0.f;
  const Vec3f center = Vec3f(place[0] - 0.5f, place[1] - 0.5f, place[2] - 0.5f) * far;
  std::array<Vec3f, 3> corners;
  for (Vec3f& corner : corners) {
    const auto u = numbers.next();
    corner = center + Vec3f(u[0] - 0.5f, (u[1] - 0.5f) * thin, u[2] - 0.5f) * size;
  }
  const int axis = static_cast<int>(shape[3] * 6);
  if (axis < 3)
    for (Vec3f& corner : corners) corner[axis] = corners[0][axis];
  return corners;
}

template <class T>
int count_self_hits(std::uint64_t rays) {
  int hits = 0;
  for (std::uint64_t i = 0; i < rays; ++i) {
    Numbers numbers{i};
    const std::array<Vec3f, 3> v = awkward_triangle(numbers);
    const Index3 index{0, 1, 2};
    const TriangleList list({v.data(), &index, 1});
    const Vec3<T> v0(v[0]), v1(v[1]), v2(v[2]);
    const Vec3<T> normal(normalize(cross(Vec3d(v[1]) - Vec3d(v[0]), Vec3d(v[2]) - Vec3d(v[0]))));
    if (!is_finite(normal)) continue;
    const auto u = numbers.next();
    const auto [b1, b2] = uniform_triangle(Point2<T>{T(u[0]), T(u[1])});
    const TrianglePoint<T> x = point_on_triangle(v0, v1, v2, b1, b2);
    const auto w = numbers.next();
    Vec3<T> direction = spherical(T(1 - 2 * w[0]), T(4 * w[0] * (1 - w[0])), 2 * pi<T> * T(w[1]));
    if (w[2] < 0.3f)
      direction += normal * (-dot(direction, normal) * T(1 - std::exp2(-24 * w[3])));  // grazing
    const Vec3<T> from = offset_origin(x.p, x.error, normal, direction);
    hits += list.closest(Ray<T>{from, direction}).found();

    const Vec3<T> start = x.p + direction * T(u[2] + 0.01f), segment = start - x.p;
    const Vec3<T> error = x.error + error_of_test(max_component(magnitude(segment)));
    if (std::abs(dot(normal, segment)) <= dot(magnitude(normal), error)) continue;  // in one plane
    const Vec3<T> to = offset_origin(x.p, error, normal, segment);
    hits += list.occluded(Ray<T>{start, to - start, T(1)});
  }
  return hits;
}

}  // namespace

TEMPLATE_TEST_CASE("rays do not meet the triangle they start from or end on", "[numerics]", float, double) {
  CHECK(count_self_hits<TestType>(300000) == 0);
}
