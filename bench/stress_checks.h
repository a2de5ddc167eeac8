#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "generate/shapes.h"
#include "tracers.h"

namespace castray {

/// A mesh in float that owns its arrays.
struct FloatMesh {
  std::vector<Vec3f> positions;
  std::vector<Index3> triangles;

  MeshView view() const {
    return {positions.data(), triangles.data(), static_cast<std::uint32_t>(triangles.size())};
  }
  void add(const Vec3f& a, const Vec3f& b, const Vec3f& c);
};

/// The shape moved by `offset` of its sizes along each axis, times `scale`.
FloatMesh place(const Shape& shape, double scale = 1, double offset = 0);

/// Sheets of two triangles, again and again in the same four planes.
FloatMesh coplanar_stack(int copies);

/// Meshes of all kinds, by name, each of about `triangles`.
std::vector<std::pair<std::string, FloatMesh>> standard_meshes(std::uint32_t triangles);

/// A closed shape, and random points well inside it.
struct ClosedShape {
  std::string name;
  Shape shape;
  std::function<Vec3d(std::mt19937&)> inside;
};
ClosedShape closed_icosphere(std::uint32_t frequency);
ClosedShape closed_torus_knot(std::uint32_t along, std::uint32_t around);
/// Rings pulled towards one pole: nearly all triangles are slivers.
ClosedShape closed_sliver_sphere(std::uint32_t around, std::uint32_t rings);

/// Rays from inside a closed shape exactly at its vertices, at points of its edges, and a last bit beside
/// vertices: each has something to hit.
template <class T>
std::vector<Ray<T>> rays_at_seams(const ClosedShape& closed, const FloatMesh& mesh, double scale,
                                  double offset, std::size_t count, std::uint32_t seed);

/// Rays in and around a mesh of any place and size: in all directions, along axes, from vertices, at
/// vertices, with and without an end.
std::vector<Ray<float>> rays_around(const FloatMesh& mesh, std::size_t count, std::uint32_t seed,
                                    double scale = 1, double offset = 0);

/// Every combination of ordinary numbers, zeros of both signs, infinities, NaN, and the very small and large,
/// in origin and direction.
std::vector<Ray<float>> odd_rays();

/// How many hit nothing, nearest or any. This and the next use all OpenMP threads.
std::size_t count_leaks(const Tracer& tracer, const std::vector<Ray<float>>& rays);
std::size_t count_leaks(const Bvh& bvh, const std::vector<Ray<double>>& rays);

/// On how many the two differ in a bit of anything, or the first in itself between nearest and any hit.
std::size_t count_disagreements(const Tracer& tracer, const Tracer& expected,
                                const std::vector<Ray<float>>& rays);

}  // namespace castray
