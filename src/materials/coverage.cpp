#include "materials/coverage.h"

#include <algorithm>
#include <cmath>

#include "core/contract.h"
#include "geometry/placement.h"
#include "materials/dielectric.h"
#include "materials/surface_values.h"

namespace castray {

namespace {

/// On whichever side, of any length; where the interpolated normal and the triangle's are on different sides
/// of the ray, the triangle's.
template <class T>
Vec3d normal_at(const Scene& scene, const Hit<T>& hit, const Vec3d& direction) {
  const auto in_scene = [&](const Vec3d& n) {
    return hit.instance < scene.instances.size() ? Placed(scene.instances[hit.instance]).normal(n) : n;
  };
  const Index3& t = scene.triangles[hit.triangle];
  const Vec3d v0(scene.positions[t[0]]), v1(scene.positions[t[1]]), v2(scene.positions[t[2]]);
  const Vec3d flat = in_scene(cross(v1 - v0, v2 - v0));
  if (scene.triangle_normals.empty()) return flat;
  const Index3& n = scene.triangle_normals[hit.triangle];
  if (n[0] == Scene::no_index) return flat;
  const TrianglePlace<double> place{hit.triangle, hit.b1, hit.b2};
  const Vec3d smooth = in_scene(
      place.interpolate(Vec3d(scene.normals[n[0]]), Vec3d(scene.normals[n[1]]), Vec3d(scene.normals[n[2]])));
  const bool usable = dot(smooth, flat) * dot(smooth, direction) * dot(flat, direction) > 0;
  return usable ? smooth : flat;
}

/// All but what of each colour goes straight on.
template <class T>
Vec3<T> shares_of_window(const Scene& scene, const Material& window, const Hit<T>& hit,
                         const Vec3d& direction) {
  const Vec3<T> kept =
      window.map(SurfaceParameter::transmittance).used()
          ? surface_values(scene, window, TrianglePlace<T>{hit.triangle, hit.b1, hit.b2}).color(slot_kd)
          : Vec3<T>(window.transmittance);
  const Vec3d normal = normal_at(scene, hit, direction);
  const double size2 = dot(normal, normal) * dot(direction, direction);
  const double cosine = size2 > 0 ? std::min(std::abs(dot(normal, direction)) / std::sqrt(size2), 1.0) : 1.0;
  const T reflected = pane_reflectance(static_cast<T>(cosine), static_cast<T>(window.ior));
  const auto share = [reflected](T passed) { return reflected + (1 - reflected) * (1 - passed); };
  return {share(kept.x), share(kept.y), share(kept.z)};
}

}  // namespace

Coverage::Coverage(const Scene& scene)
    : scene_(scene), tints_(std::ranges::any_of(scene.materials, &Material::tints)) {
  if (std::ranges::none_of(scene.materials, &Material::may_have_holes)) return;
  partial_.resize((scene.triangles.size() + 31) / 32);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i)
    if (scene.material_of(i).may_have_holes()) partial_[i / 32] |= 1u << (i % 32);
}

template <class T>
T Coverage::share_there(const Hit<T>& hit, const Vec3<T>& direction) const {
  const T share = coverage_at(scene_, TrianglePlace<T>{hit.triangle, hit.b1, hit.b2});
  const Material& material = scene_.material_of(hit.triangle);
  if (!material.is_window()) return share;
  return share * min_component(shares_of_window(scene_, material, hit, Vec3d(direction)));
}

template <class T>
Vec3<T> Coverage::tint(const Hit<T>& hit, const Vec3<T>& direction) const {
  const Material& material = scene_.material_of(hit.triangle);
  if (!material.tints()) return Vec3<T>(1);
  const T share = coverage_at(scene_, TrianglePlace<T>{hit.triangle, hit.b1, hit.b2});
  const Vec3<T> passed = Vec3<T>(1) - shares_of_window(scene_, material, hit, Vec3d(direction)) * share;
  const T most = max_component(passed);
  return most > 0 ? passed / most : Vec3<T>(1);
}

template <class T>
HitFilter<T> Coverage::there_in(std::uint32_t world, const Vec3<T>& direction) const {
  if (partial_.empty()) return {};
  return [this, world, direction](const Hit<T>& hit) {
    if (!is_partial(hit.triangle)) return true;
    const T share = share_there(hit, direction);
    if (share >= 1) return true;
    if (!(share > 0)) return false;
    const std::uint32_t here = hit.instance == Scene::no_index ? world : hash_combine(world, hit.instance);
    return presence_number(here, hit.triangle, static_cast<float>(hit.b1), static_cast<float>(hit.b2)) <
           share;
  };
}

template float Coverage::share_there(const Hit<float>&, const Vec3<float>&) const;
template Vec3<float> Coverage::tint(const Hit<float>&, const Vec3<float>&) const;
template Vec3<double> Coverage::tint(const Hit<double>&, const Vec3<double>&) const;
template HitFilter<float> Coverage::there_in(std::uint32_t, const Vec3<float>&) const;
template HitFilter<double> Coverage::there_in(std::uint32_t, const Vec3<double>&) const;

}  // namespace castray
