#pragma once

#include <vector>

#include "core/contract.h"
#include "core/error_bounds.h"
#include "core/frame.h"
#include "geometry/placement.h"
#include "materials/bent_normal.h"
#include "materials/lobe_turn.h"
#include "materials/material_table.h"
#include "materials/surface_values.h"

namespace castray {

/// A point of the scene as a ray meets it.
template <class T>
struct Surface {
  Vec3<T> p, error;   ///< the point and a bound of its rounding error per coordinate
  T test_growth;      ///< Placed::growth
  Vec3<T> normal;     ///< geometric, unit, as the triangle's winding has it
  Vec3<T> to_viewer;  ///< unit, against the ray
  Frame<T> frame;     ///< of the shading normal
  Vec3<T> wo;         ///< to_viewer in the shading frame
  Bsdf<T> bsdf;
  Vec3<T> emission;  ///< of the side that emits
  TrianglePlace<T> place{Scene::no_index, 0, 0};
  std::uint16_t material = 0;

  /// Whether wi, sampled or evaluated in the shading frame as `local`, is on the same side of the real
  /// surface: shading normals must not let light through an opaque one.
  bool consistent(const Vec3<T>& wi, const Vec3<T>& local) const {
    const bool same_side = (dot(wi, normal) > 0) == (dot(to_viewer, normal) > 0);
    return same_side == ((local.z > 0) == (wo.z > 0));
  }
};

/// What of a scene is needed to turn hits into surfaces; the scene must outlive it.
template <class T>
class Surfaces {
 public:
  explicit Surfaces(const Scene& scene)
      : scene_(scene), materials_(scene.materials), places_(scene.instances.begin(), scene.instances.end()) {
    normals_.reserve(scene.triangles.size());
    for (const Index3& t : scene.triangles) {
      const Vec3d v0(scene.positions[t[0]]), v1(scene.positions[t[1]]), v2(scene.positions[t[2]]);
      normals_.emplace_back(normalize(cross(v1 - v0, v2 - v0)));
    }
  }

  /// The surface that `ray`, of unit direction, meets at `hit`. `pixel`: what the pixel of a camera's ray
  /// sees. `world`: the path's, which decides what is glass (glass_number).
  Surface<T> at(const Hit<T>& hit, const Ray<T>& ray, std::uint32_t world,
                const std::optional<PixelView<T>>& pixel = {}) const {
    return hit.instance == Scene::no_index
               ? at(hit, ray, world, InPlace(), pixel)
               : at(hit, ray, hash_combine(world, hit.instance), places_[hit.instance], pixel);
  }

 private:
  template <class Placement>
  Surface<T> at(const Hit<T>& hit, const Ray<T>& ray, std::uint32_t world, const Placement& placement,
                const std::optional<PixelView<T>>& pixel) const {
    const Index3& t = scene_.triangles[hit.triangle];
    const TrianglePoint<T> point =
        placement.point(point_on_triangle(Vec3<T>(scene_.positions[t[0]]), Vec3<T>(scene_.positions[t[1]]),
                                          Vec3<T>(scene_.positions[t[2]]), hit.b1, hit.b2));
    const Vec3<T> normal = placement.normal(normals_[hit.triangle]);
    const Vec3<T> to_viewer = -ray.direction;
    const std::uint16_t material = material_at(hit, world, dot(normal, to_viewer) > 0);
    const Material& m = scene_.materials[material];
    const TrianglePlace<T> place{hit.triangle, hit.b1, hit.b2};
    const Frame<T> frame =
        shading_frame(m, place, placement, normal, shading_normal(m, place, placement, normal, to_viewer));
    Surface<T> surface{point.p,
                       point.error,
                       T(placement.growth()),
                       normal,
                       to_viewer,
                       frame,
                       frame.to_local(to_viewer),
                       materials_[material],
                       Vec3<T>(m.ke),
                       place,
                       material};
    if (m.has_maps() || m.vertex_colors) {
      const auto seen = pixel ? footprint_at(*pixel, point.p, normal, place, placement) : std::nullopt;
      const SurfaceValues<T> values = surface_values(scene_, m, place, seen);
      surface.bsdf = materials_.at(material, values);
      surface.emission = values.color(slot_emission);
    }
    return surface;
  }

  std::uint16_t material_at(const Hit<T>& hit, std::uint32_t world, bool front) const {
    const std::uint16_t material = scene_.on_side(scene_.triangle_material[hit.triangle], front);
    const Material& m = scene_.materials[material];
    const auto is_glass = [&] {
      return glass_number(world, hit.triangle, static_cast<float>(hit.b1), static_cast<float>(hit.b2)) <
             m.glass_share();
    };
    return m.has_glass() && is_glass() ? static_cast<std::uint16_t>(m.glass) : material;
  }

  /// What a pixel sees of the plane of a triangle with this normal, around the point p.
  template <class Placement>
  std::optional<Footprint<T>> footprint_at(const PixelView<T>& pixel, const Vec3<T>& p, const Vec3<T>& normal,
                                           const TrianglePlace<T>& place, const Placement& placement) const {
    const auto uv = uv_at(scene_, place);
    const auto move = uv_derivatives<T>(scene_, place.triangle, placement);
    const T towards = dot(normal, pixel.d), t = dot(normal, p - pixel.o) / towards;
    if (!uv || !move || !(t > 0) || !std::isfinite(t)) return {};
    const Vec3<T> across_u = cross(move->dv, normal), across_v = cross(normal, move->du);
    const T scale = dot(move->du, across_u);
    const auto uv_of = [&](const Vec3<T>& w) {
      return std::array<T, 2>{dot(across_u, w) / scale, dot(across_v, w) / scale};
    };
    const auto change = [&](const Vec3<T>& o, const Vec3<T>& d) {
      const Vec3<T> w = o + d * t;
      return uv_of(w - pixel.d * (dot(normal, w) / towards));
    };
    const auto [u, v] = uv_of(pixel.o + pixel.d * t - p);
    return Footprint<T>{{(*uv)[0] + u, (*uv)[1] + v},        change(pixel.o_right, pixel.d_right),
                        change(pixel.o_down, pixel.d_down),  dot(normal, pixel.d_right) / towards,
                        dot(normal, pixel.d_down) / towards, pixel.sample};
  }

  /// The interpolated vertex normal, on the geometric normal's side; the geometric one where there is none or
  /// where the viewer would be behind it.
  template <class Placement>
  Vec3<T> smooth_normal(const TrianglePlace<T>& place, const Placement& placement, const Vec3<T>& normal,
                        const Vec3<T>& to_viewer) const {
    if (scene_.triangle_normals.empty()) return normal;
    const Index3& n = scene_.triangle_normals[place.triangle];
    if (n[0] == Scene::no_index) return normal;
    const auto at_corner = [&](std::size_t i) { return placement.normal(Vec3<T>(scene_.normals[n[i]])); };
    Vec3<T> smooth = normalize(place.interpolate(at_corner(0), at_corner(1), at_corner(2)));
    if (!is_finite(smooth)) return normal;
    if (dot(smooth, normal) < 0) smooth = -smooth;
    return dot(smooth, to_viewer) * dot(normal, to_viewer) > 0 ? smooth : normal;
  }

  /// The same, bent by the material's maps where the viewer is still in front of it.
  template <class Placement>
  Vec3<T> shading_normal(const Material& m, const TrianglePlace<T>& place, const Placement& placement,
                         const Vec3<T>& normal, const Vec3<T>& to_viewer) const {
    const Vec3<T> smooth = smooth_normal(place, placement, normal, to_viewer);
    const Vec3<T> bent = bent_normal(scene_, m, place, placement, smooth);
    const bool usable = dot(bent, to_viewer) * dot(normal, to_viewer) > 0 && dot(bent, normal) > 0;
    return usable ? bent : smooth;
  }

  /// The frame of a shading normal; of an anisotropic metal its x axis is where the lobe is wide: seen along
  /// the shading normal, a direction in the plane of the triangle.
  template <class Placement>
  Frame<T> shading_frame(const Material& m, const TrianglePlace<T>& place, const Placement& placement,
                         const Vec3<T>& normal, const Vec3<T>& shading_normal) const {
    if (!(m.anisotropy > 0)) return make_frame(shading_normal);
    const auto move = uv_derivatives<T>(scene_, place.triangle, placement);
    const Vec3<T> u = move ? normalize(move->du) : make_frame(normal).tangent;
    const Vec3<T> v = cross(normal, u) * (move ? move->handedness : T(1));
    const auto [x, y] = lobe_turn(scene_, m, place);
    const Vec3<T> along = u * x + v * y;
    const Vec3<T> tangent = normalize(along - shading_normal * dot(along, shading_normal));
    return {tangent, cross(shading_normal, tangent), shading_normal};
  }

  const Scene& scene_;
  MaterialTable<T> materials_;
  std::vector<Vec3<T>> normals_;
  std::vector<Placed> places_;  ///< by instance
};

}  // namespace castray
