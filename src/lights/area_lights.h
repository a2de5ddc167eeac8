#pragma once

#include <vector>

#include "castray/scene.h"
#include "core/warp.h"

namespace castray {

/// A point on an emissive triangle.
template <class T>
struct LightPoint {
  Vec3<T> p;
  Vec3<T> error;   ///< bound of |p - exact point|, per coordinate
  Vec3<T> normal;  ///< unit, geometric
  Vec3<T> radiance;
  T pdf_area = 0;  ///< per area of scene space, the choice of the triangle included
  T choice = 0;    ///< probability with which its triangle was chosen
  std::uint32_t triangle = Scene::no_index;
  bool two_sided = false;
};

/// All emissive triangles of a scene, which must outlive it. One is chosen with a probability proportional to
/// its area times the luminance of its mean emission, then a point uniform on it: the density of a point
/// depends on its material only.
template <class T>
class AreaLights {
 public:
  explicit AreaLights(const Scene& scene);

  bool empty() const { return triangles_.empty(); }

  /// A point for u_choice in [0,1) and u. Not to be called where empty().
  LightPoint<T> sample(double u_choice, Point2<T> u) const;

  /// The density, per area, with which `sample` returns a given point of a triangle of `material`.
  T pdf_area(std::size_t material) const { return material_density_[material]; }

 private:
  struct Triangle {
    Vec3<T> v0, v1, v2, normal, radiance;
    T pdf_area, choice;
    std::uint32_t index;
    bool two_sided;
  };

  const Scene& scene_;
  std::vector<Triangle> triangles_;
  std::vector<double> cumulative_;  ///< probability of choosing one of the lights 0..i
  std::vector<T> material_density_;
};

}  // namespace castray
