#pragma once

#include <vector>

#include "castray/scene.h"
#include "core/warp.h"
#include "lights/emission_cells.h"
#include "materials/surface_values.h"

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

/// All emissive triangles of a scene, which must outlive it, or their cells. One is chosen with a probability
/// proportional to its area times the luminance of its emission, then a point uniform on it.
template <class T>
class AreaLights {
 public:
  explicit AreaLights(const Scene& scene);

  bool empty() const { return triangles_.empty(); }

  /// A point for u_choice in [0,1) and u. Not to be called where empty().
  LightPoint<T> sample(double u_choice, Point2<T> u) const;

  /// The density, per area, with which `sample` returns a given point of a triangle that emits, on the side
  /// that has this material.
  T pdf_area(std::uint16_t material, const TrianglePlace<T>& at) const {
    return material_density_[material] * static_cast<T>(cells_.share(at.triangle, at.b1, at.b2));
  }

 private:
  struct Triangle {
    Vec3<T> v0, v1, v2;
    Vec3<T> normal;  ///< of the side that emits
    Vec3<T> radiance;
    std::uint16_t material;
    T choice;
    TrianglePlace<T> corner;  ///< where it begins in the scene's triangle, and
    T step;                   ///< what barycentrics grow by along its edges
    bool two_sided;
  };

  const Scene& scene_;
  EmissionCells cells_;
  std::vector<Triangle> triangles_;
  std::vector<double> cumulative_;  ///< probability of choosing one of the lights 0..i
  std::vector<T> material_density_;
};

}  // namespace castray
