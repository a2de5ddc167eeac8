#include "generate/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "castray/error.h"
#include "core/nearest.h"
#include "core/sequences.h"
#include "generate/leaves.h"
#include "generate/random.h"

namespace castray {

namespace {

using std::numbers::pi;

double lattice_value(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t seed) {
  const auto bits = [](std::int64_t i) { return static_cast<std::uint32_t>(i); };
  return hash32(bits(x) ^ hash32(bits(y) ^ hash32(bits(z) ^ hash32(seed)))) * 0x1p-31 - 1;
}

double mix(double a, double b, double t) { return a + (b - a) * t; }

/// Smooth noise in [-1,1]: values at the integer lattice, blended.
double noise(const Vec3d& p, std::uint32_t seed) {
  const Vec3d cell{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  const Vec3d t = p - cell;
  const Vec3d s = t * t * (Vec3d(3.0) - t * 2.0);
  const auto x = static_cast<std::int64_t>(cell.x), y = static_cast<std::int64_t>(cell.y),
             z = static_cast<std::int64_t>(cell.z);
  const auto along_x = [&](std::int64_t j, std::int64_t k) {
    return mix(lattice_value(x, y + j, z + k, seed), lattice_value(x + 1, y + j, z + k, seed), s.x);
  };
  return mix(mix(along_x(0, 0), along_x(1, 0), s.y), mix(along_x(0, 1), along_x(1, 1), s.y), s.z);
}

double fractal_noise(const Vec3d& p, int octaves, std::uint32_t seed) {
  double sum = 0, amplitude = 0.5, frequency = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * noise(p * frequency, seed + static_cast<std::uint32_t>(i));
    amplitude *= 0.5;
    frequency *= 2;
  }
  return sum;
}

struct Icosahedron {
  std::array<Vec3d, 12> corners;
  std::array<std::array<std::uint32_t, 3>, 20> faces;
};

Icosahedron icosahedron() {
  const double g = std::numbers::phi;
  return {{{{-1, g, 0},
            {1, g, 0},
            {-1, -g, 0},
            {1, -g, 0},
            {0, -1, g},
            {0, 1, g},
            {0, -1, -g},
            {0, 1, -g},
            {g, 0, -1},
            {g, 0, 1},
            {-g, 0, -1},
            {-g, 0, 1}}},
          {{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
            {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
            {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}}};
}

/// Cuts the faces of the icosahedron; points that faces share are made once.
class GeodesicBuilder {
 public:
  explicit GeodesicBuilder(std::uint32_t frequency) : frequency_(frequency) {
    for (const auto& face : solid_.faces) cut_face(face);
  }

  Shape shape;

 private:
  /// Corners and their weights, which add up to the frequency; those of weight 0 left out.
  using Key = std::array<std::pair<std::uint32_t, std::uint32_t>, 3>;

  std::uint32_t point(const std::array<std::uint32_t, 3>& face, std::uint32_t i, std::uint32_t j) {
    Key key{{{face[0], frequency_ - i - j}, {face[1], i}, {face[2], j}}};
    for (auto& [corner, weight] : key)
      if (weight == 0) corner = Scene::no_index;
    std::ranges::sort(key);
    const auto [found, is_new] = points_.try_emplace(key, static_cast<std::uint32_t>(shape.positions.size()));
    if (is_new) {
      Vec3d sum;
      for (const auto& [corner, weight] : key)
        if (weight > 0) sum += solid_.corners[corner] * static_cast<double>(weight);
      shape.positions.push_back(normalize(sum));
    }
    return found->second;
  }

  void cut_face(const std::array<std::uint32_t, 3>& face) {
    for (std::uint32_t i = 0; i < frequency_; ++i)
      for (std::uint32_t j = 0; i + j < frequency_; ++j) {
        shape.triangles.push_back({point(face, i, j), point(face, i + 1, j), point(face, i, j + 1)});
        if (i + j + 1 < frequency_)
          shape.triangles.push_back(
              {point(face, i + 1, j), point(face, i + 1, j + 1), point(face, i, j + 1)});
      }
  }

  Icosahedron solid_ = icosahedron();
  std::uint32_t frequency_;
  std::map<Key, std::uint32_t> points_;
};

Vec3d knot_point(double t) {
  const double r = 0.55 + 0.22 * std::cos(3 * t);
  return {r * std::cos(2 * t), r * std::sin(2 * t), 0.22 * std::sin(3 * t)};
}

std::uint32_t rounded_root(double value) {
  return static_cast<std::uint32_t>(std::max(1.0, std::round(std::sqrt(value))));
}

}  // namespace

Shape icosphere(std::uint32_t frequency) { return GeodesicBuilder(std::max(1u, frequency)).shape; }

Shape smooth_icosphere(std::uint32_t frequency) {
  Shape shape = icosphere(frequency);
  shape.normals = shape.positions;
  return shape;
}

Shape blob(std::uint32_t frequency, std::uint32_t seed) {
  Shape shape = icosphere(frequency);
  for (Vec3d& p : shape.positions) p *= 0.72 + 0.5 * fractal_noise(p * 1.8 + Vec3d(5.0), 4, seed);
  return shape;
}

Shape torus_knot(std::uint32_t along, std::uint32_t around) {
  constexpr double tube = 0.12;
  Shape shape;
  for (std::uint32_t i = 0; i < along; ++i) {
    const double t = 2 * pi * i / along, step = 1e-4;
    const Vec3d center = knot_point(t), ahead = normalize(knot_point(t + step) - knot_point(t - step));
    const Vec3d side = normalize(cross(ahead, Vec3d{center.x, center.y, 0})), out = cross(side, ahead);
    for (std::uint32_t j = 0; j < around; ++j) {
      const double angle = 2 * pi * j / around;
      shape.positions.push_back(center + (out * std::cos(angle) + side * std::sin(angle)) * tube);
    }
  }
  const auto index = [&](std::uint32_t i, std::uint32_t j) { return (i % along) * around + j % around; };
  for (std::uint32_t i = 0; i < along; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      shape.triangles.push_back({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
      shape.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
    }
  return shape;
}

Shape terrain(std::uint32_t triangles, std::uint32_t seed) {
  const std::uint32_t columns = std::max(1u, rounded_root(triangles / 2.0));
  const std::uint32_t rows = (triangles + 2 * columns - 1) / (2 * columns);
  Shape shape;
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i <= columns; ++i) {
      const double x = 2.0 * i / columns - 1, z = 2.0 * j / rows - 1;
      shape.positions.push_back({x, 0.5 * fractal_noise({3 * x, 0, 3 * z}, 9, seed), z});
    }
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
      if (shape.triangles.size() < triangles) shape.triangles.push_back({a, c, d});
      if (shape.triangles.size() < triangles) shape.triangles.push_back({a, d, b});
    }
  return shape;
}

Shape hair(std::uint32_t triangles, std::uint32_t seed) {
  constexpr std::uint32_t segments = 8;
  constexpr double length_of_hair = 0.5, width = 1.25e-4, ball = 0.45;
  Random random(seed);
  Shape shape;
  while (shape.triangles.size() < triangles) {
    const Vec3d root = random.on_sphere(), bend = random.on_sphere() * 0.6, across = random.on_sphere();
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    for (std::uint32_t i = 0; i <= segments; ++i) {
      const double s = static_cast<double>(i) / segments;
      const Vec3d p = root * (ball + length_of_hair * 0.8 * s) + bend * (length_of_hair * 0.4 * s * s);
      shape.positions.push_back(p - across * (width / 2));
      shape.positions.push_back(p + across * (width / 2));
    }
    for (std::uint32_t i = 0; i < segments; ++i) {
      const std::uint32_t a = first + 2 * i;
      if (shape.triangles.size() < triangles) shape.triangles.push_back({a, a + 1, a + 3});
      if (shape.triangles.size() < triangles) shape.triangles.push_back({a, a + 3, a + 2});
    }
  }
  return shape;
}

Shape soup(std::uint32_t triangles, std::uint32_t seed) {
  Random random(seed);
  const double size = 1.5 / std::cbrt(static_cast<double>(triangles));
  Shape shape;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const Vec3d center = random.in_cube() * (1 - size);
    for (int i = 0; i < 3; ++i) shape.positions.push_back(center + random.in_cube() * size);
    shape.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return shape;
}

Shape sticks(std::uint32_t triangles, std::uint32_t seed) {
  constexpr double width = 0.002;
  Random random(seed);
  Shape shape;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const Vec3d from = random.in_cube() * (1 - width), to = random.in_cube() * (1 - width);
    for (const Vec3d& p : {from, to, to + random.on_sphere() * width}) shape.positions.push_back(p);
    shape.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return shape;
}

Shape make_shape(std::string_view name, std::uint32_t triangles, std::uint32_t seed) {
  if (triangles == 0) throw InputError("a shape needs at least 1 triangle");
  if (name == "icosphere") return icosphere(rounded_root(triangles / 20.0));
  if (name == "smooth_icosphere") return smooth_icosphere(rounded_root(triangles / 20.0));
  if (name == "blob") return blob(rounded_root(triangles / 20.0), seed);
  if (name == "torus_knot") {
    const std::uint32_t around = std::max(3u, rounded_root(triangles / 40.0));
    return torus_knot(std::max(3u, triangles / (2 * around)), around);
  }
  if (name == "terrain") return terrain(triangles, seed);
  if (name == "hair") return hair(triangles, seed);
  if (name == "soup") return soup(triangles, seed);
  if (name == "sticks") return sticks(triangles, seed);
  if (name == "masked_leaves") return masked_leaves(std::max(1u, triangles / 2), seed);
  if (name == "cut_leaves") return cut_leaves(std::max(1u, triangles / triangles_of_cut_leaf), seed);
  throw InputError("no shape '" + std::string(name) + "'" +
                   suggestion(name, {"icosphere", "smooth_icosphere", "blob", "torus_knot", "terrain", "hair",
                                     "soup", "sticks", "masked_leaves", "cut_leaves"}));
}

}  // namespace castray
