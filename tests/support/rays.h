#pragma once

#include <random>

#include "accel/ray.h"

namespace castray {

/// Random rays around a mesh of size 1 at the origin: from points in and near it, in all directions, some
/// along the axes, some starting or aimed exactly at vertices.
class RandomRays {
 public:
  RandomRays(const MeshView& mesh, std::uint32_t seed) : mesh_(mesh), random_(seed) {}

  template <class T = float>
  Ray<T> next() {
    Ray<T> ray{Vec3<T>(point(1.5f)), Vec3<T>(point(1)), std::numeric_limits<T>::infinity()};
    switch (random_() % 8) {
      case 0:
        ray.direction = Vec3<T>(vertex()) - ray.origin;
        break;
      case 1:
        ray.origin = Vec3<T>(vertex());
        break;
      case 2:
        ray.direction = axis<T>();
        break;
      case 3:
        ray.direction = axis<T>(), ray.origin = Vec3<T>(vertex()) - ray.direction;
        break;
      case 4:
        ray.t_max = T(number_(random_)) + 1;
        break;
      default:
        break;
    }
    return ray;
  }

 private:
  Vec3f point(float size) {
    const float x = number_(random_), y = number_(random_), z = number_(random_);
    return size * Vec3f(x, y, z);
  }
  Vec3f vertex() { return mesh_.positions[mesh_.triangles[random_() % mesh_.count][random_() % 3]]; }
  template <class T>
  Vec3<T> axis() {
    Vec3<T> d;
    d[static_cast<int>(random_() % 3)] = random_() % 2 ? T(1) : T(-1);
    return d;
  }

  MeshView mesh_;
  std::mt19937 random_;
  std::uniform_real_distribution<float> number_{-1, 1};
};

}  // namespace castray
