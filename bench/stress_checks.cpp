#include "stress_checks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace castray {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

Vec3d random_in_cube(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const double x = number(random), y = number(random), z = number(random);
  return {x, y, z};
}

Vec3d near_middle(std::mt19937& random) { return random_in_cube(random) * 0.3; }

Vec3d place(const Vec3d& p, double scale, double offset) {
  return (p + Vec3d(offset, -offset, offset)) * scale;
}

/// The point in the ring of `around` vertices from `first` on.
Vec3d middle_of_ring(const Shape& shape, std::size_t first, std::size_t around) {
  Vec3d sum;
  for (std::size_t i = 0; i < around; ++i) sum += shape.positions[first + i];
  return sum * (1.0 / static_cast<double>(around));
}

}  // namespace

void FloatMesh::add(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto first = static_cast<std::uint32_t>(positions.size());
  positions.insert(positions.end(), {a, b, c});
  triangles.push_back({first, first + 1, first + 2});
}

FloatMesh place(const Shape& shape, double scale, double offset) {
  FloatMesh mesh{{}, shape.triangles};
  for (const Vec3d& p : shape.positions) mesh.positions.emplace_back(place(p, scale, offset));
  return mesh;
}

FloatMesh coplanar_stack(int copies) {
  FloatMesh mesh;
  for (int i = 0; i < copies; ++i) {
    const float z = static_cast<float>(i % 4) / 4;
    mesh.add({-1, -1, z}, {1, -1, z}, {1, 1, z});
    mesh.add({-1, -1, z}, {1, 1, z}, {-1, 1, z});
  }
  return mesh;
}

std::vector<std::pair<std::string, FloatMesh>> standard_meshes(std::uint32_t triangles) {
  std::vector<std::pair<std::string, FloatMesh>> meshes;
  for (const char* name : {"icosphere", "blob", "torus_knot", "terrain", "hair", "soup", "sticks"}) {
    meshes.emplace_back(name, place(make_shape(name, triangles, 1)));
  }
  meshes.emplace_back("sliver sphere", place(closed_sliver_sphere(triangles / 60, 30).shape));
  meshes.emplace_back("coplanar stack", coplanar_stack(static_cast<int>(triangles / 2)));
  return meshes;
}

ClosedShape closed_icosphere(std::uint32_t frequency) {
  return {"icosphere", icosphere(frequency), near_middle};
}

ClosedShape closed_torus_knot(std::uint32_t along, std::uint32_t around) {
  const Shape shape = torus_knot(along, around);
  const auto inside = [shape, along, around](std::mt19937& random) {
    const Vec3d middle = middle_of_ring(shape, random() % along * around, around);
    return middle + random_in_cube(random) * 0.02;
  };
  return {"torus knot", shape, inside};
}

ClosedShape closed_sliver_sphere(std::uint32_t around, std::uint32_t rings) {
  Shape shape;
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    const double z = 1 - 2 * std::pow((ring + 1.0) / (rings + 1.0), 4), r = std::sqrt(1 - z * z);
    for (std::uint32_t i = 0; i < around; ++i) {
      const double phi = 2 * std::numbers::pi * i / around;
      shape.positions.push_back({r * std::cos(phi), r * std::sin(phi), z});
    }
  }
  const std::uint32_t top = around * rings, bottom = top + 1;
  shape.positions.insert(shape.positions.end(), {{0, 0, 1}, {0, 0, -1}});
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t next = (i + 1) % around, last = around * (rings - 1);
    shape.triangles.push_back({top, i, next});
    shape.triangles.push_back({bottom, last + next, last + i});
    for (std::uint32_t ring = 0; ring < last; ring += around) {
      shape.triangles.push_back({ring + i, ring + around + i, ring + around + next});
      shape.triangles.push_back({ring + i, ring + around + next, ring + next});
    }
  }
  return {"sliver sphere", shape, near_middle};
}

template <class T>
std::vector<Ray<T>> rays_at_seams(const ClosedShape& closed, const FloatMesh& mesh, double scale,
                                  double offset, std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(0, 1);
  std::vector<Ray<T>> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Index3& triangle = mesh.triangles[random() % mesh.triangles.size()];
    const Vec3<T> a(mesh.positions[triangle[0]]), b(mesh.positions[triangle[1]]);
    const Vec3<T> origin(Vec3f(place(closed.inside(random), scale, offset)));
    Vec3<T> target = a;
    if (i % 3 == 1) target = a + static_cast<T>(number(random)) * (b - a);
    if (i % 3 == 2) {
      for (int axis = 0; axis < 3; ++axis) {
        target[axis] = std::nextafter(target[axis], random() % 2 ? T(infinity) : -T(infinity));
      }
    }
    rays[i] = {origin, target - origin};
  }
  return rays;
}
template std::vector<Ray<float>> rays_at_seams(const ClosedShape&, const FloatMesh&, double, double,
                                               std::size_t, std::uint32_t);
template std::vector<Ray<double>> rays_at_seams(const ClosedShape&, const FloatMesh&, double, double,
                                                std::size_t, std::uint32_t);

std::vector<Ray<float>> rays_around(const FloatMesh& mesh, std::size_t count, std::uint32_t seed,
                                    double scale, double offset) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(0, 1);
  const auto vertex = [&] {
    return mesh.positions[mesh.triangles[random() % mesh.triangles.size()][random() % 3]];
  };
  const auto axis = [&] {
    Vec3f d;
    d[static_cast<int>(random() % 3)] = static_cast<float>(random() % 2 ? scale : -scale);
    return d;
  };
  std::vector<Ray<float>> rays(count);
  for (Ray<float>& ray : rays) {
    ray.origin = Vec3f(place(random_in_cube(random) * 1.5, scale, offset));
    ray.direction = Vec3f(random_in_cube(random) * scale);
    const unsigned kind = random() % 8;
    if (kind == 0) ray.direction = vertex() - ray.origin;
    if (kind == 1) ray.origin = vertex();
    if (kind == 2) ray.direction = axis();
    if (kind == 3) ray.direction = axis(), ray.origin = vertex() - ray.direction;
    if (kind == 4) ray.t_max = 2 * number(random);
  }
  return rays;
}

std::vector<Ray<float>> odd_rays() {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> numbers = {0.0f,  -0.0f, 0.25f,    -1.0f,     1e-40f, -1e-20f,
                                      1e20f, 3e38f, infinity, -infinity, nan};
  std::vector<Vec3f> triples;
  for (const float x : numbers) {
    for (const float y : numbers) {
      for (const float z : numbers) triples.push_back({x, y, z});
    }
  }
  std::vector<Ray<float>> rays;
  const std::vector<float> ends = {infinity, 1.0f, 1e30f, 0.0f, -1.0f, nan};
  for (const Vec3f& origin : triples) {
    for (const Vec3f& direction : triples)
      rays.push_back({origin, direction, ends[rays.size() % ends.size()]});
  }
  return rays;
}

namespace {

/// Sums count(first, n) over stretches of [0, size), by all threads.
template <class Count>
std::size_t sum_in_parallel(std::size_t size, const Count& count) {
  constexpr std::size_t stretch = 4096;
  std::size_t sum = 0;
#pragma omp parallel for reduction(+ : sum) schedule(dynamic)
  for (std::size_t first = 0; first < size; first += stretch)
    sum += count(first, std::min(stretch, size - first));
  return sum;
}

struct Answers {
  std::vector<Hit<float>> hits;
  std::vector<std::uint8_t> occluded;

  Answers(const Tracer& tracer, const RayArrays& rays, std::size_t first, std::size_t count)
      : hits(count), occluded(count) {
    tracer.closest(rays, first, count, hits.data());
    tracer.occluded(rays, first, count, occluded.data());
  }
};

bool same_bits(const Hit<float>& a, const Hit<float>& b) {
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  return a.triangle == b.triangle && bits(a.t) == bits(b.t) && bits(a.b1) == bits(b.b1) &&
         bits(a.b2) == bits(b.b2);
}

}  // namespace

std::size_t count_leaks(const Tracer& tracer, const std::vector<Ray<float>>& rays) {
  const RayArrays arrays(rays);
  return sum_in_parallel(rays.size(), [&](std::size_t first, std::size_t count) {
    const Answers answers(tracer, arrays, first, count);
    std::size_t leaks = 0;
    for (std::size_t i = 0; i < count; ++i) leaks += !answers.hits[i].found() || !answers.occluded[i];
    return leaks;
  });
}

std::size_t count_leaks(const Bvh& bvh, const std::vector<Ray<double>>& rays) {
  return sum_in_parallel(rays.size(), [&](std::size_t first, std::size_t count) {
    std::size_t leaks = 0;
    for (std::size_t i = first; i < first + count; ++i) leaks += !bvh.closest(rays[i]).found();
    return leaks;
  });
}

std::size_t count_disagreements(const Tracer& tracer, const Tracer& expected,
                                const std::vector<Ray<float>>& rays) {
  const RayArrays arrays(rays);
  return sum_in_parallel(rays.size(), [&](std::size_t first, std::size_t count) {
    const Answers a(tracer, arrays, first, count), b(expected, arrays, first, count);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < count; ++i)
      wrong += !same_bits(a.hits[i], b.hits[i]) || (a.occluded[i] != 0) != b.hits[i].found();
    return wrong;
  });
}

}  // namespace castray
