#include "instanced.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace castray {

namespace {

Transform inverse_of(const Transform& t) {
  const double determinant = t.determinant();
  const Vec3d c[3] = {cross(t.rows[1], t.rows[2]) / determinant, cross(t.rows[2], t.rows[0]) / determinant,
                      cross(t.rows[0], t.rows[1]) / determinant};
  Transform inverse{{{c[0].x, c[1].x, c[2].x}, {c[0].y, c[1].y, c[2].y}, {c[0].z, c[1].z, c[2].z}}, {}};
  inverse.translation = inverse.linear(-t.translation);
  return inverse;
}

/// Puts triangles first .. first + count - 1 of a scene, the next behind its objects, into an object that one
/// instance shows where they were. `place` maps the object's space to the scene's but for its size and
/// middle.
void make_instance(Scene& scene, std::uint32_t first, std::uint32_t count, const Transform& place) {
  const Transform back = inverse_of(place);
  std::vector<Vec3d> points;
  Vec3d low(1e300), high(-1e300);
  for (std::uint32_t t = first; t < first + count; ++t)
    for (const std::uint32_t corner : scene.triangles[t]) {
      const Vec3d& p = points.emplace_back(back.point(Vec3d(scene.positions[corner])));
      for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
    }
  const Vec3d middle = (low + high) * 0.5;
  const double unit = std::exp2(std::ceil(std::log2(max_component(high - low) / 2)));
  const bool mirrors = place.determinant() < 0;
  for (std::uint32_t t = first; t < first + count; ++t) {
    Index3& corners = scene.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.push_back(Vec3f((points[3 * (t - first) + i] - middle) / unit));
    }
    if (mirrors) std::swap(corners[1], corners[2]);
    if (!scene.triangle_uvs.empty() && mirrors) std::swap(scene.triangle_uvs[t][1], scene.triangle_uvs[t][2]);
    if (scene.triangle_normals.empty() || scene.triangle_normals[t][0] == Scene::no_index) continue;
    Index3& normals = scene.triangle_normals[t];
    for (std::uint32_t& n : normals) {
      const Vec3d v(scene.normals[n]);  // by the transpose of `place`
      scene.normals.push_back(
          Vec3f(normalize(place.rows[0] * v.x + place.rows[1] * v.y + place.rows[2] * v.z)));
      n = static_cast<std::uint32_t>(scene.normals.size() - 1);
    }
    if (mirrors) std::swap(normals[1], normals[2]);
  }
  SceneInstance instance{
      static_cast<std::uint32_t>(scene.shared_meshes.size()), {}, Vec3f(place.point(middle))};
  for (int i = 0; i < 3; ++i) instance.rows[i] = Vec3f(place.rows[i] * unit);
  scene.shared_meshes.push_back({first, count});
  scene.instances.push_back(instance);
}

}  // namespace

std::vector<Transform> kinds_of_places() {
  return {Transform::rotate({1, 2, 3}, 50).then(Transform::translate({0.1, -0.2, 0.3})),
          Transform::scale(Vec3d(1e-3)).then(Transform::rotate({3, -1, 0}, 200)),
          Transform::scale({4, 0.5, 1}).then(Transform::rotate({0, 1, 1}, 20)),
          Transform::scale({-2, 2, 2})
              .then(Transform::rotate({1, 0, 1}, 110))
              .then(Transform::translate({0.7, 0, 0})),
          Transform::scale({1, 2, 0.7})
              .then(Transform::rotate({2, 1, 0}, 40))
              .then(Transform::scale({1500, -1000, 1000}))};
}

Scene as_instances(const Scene& flat, const std::vector<Transform>& places) {
  std::vector<std::uint32_t> order(flat.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto is_own = [&](std::uint32_t t) { return flat.emits(flat.triangle_material[t]); };
  // Not the one of std::ranges: clang 14 cannot compile the view that libstdc++ 12 returns.
  const auto rest = std::stable_partition(order.begin(), order.end(), is_own);
  const auto reordered = [&](const auto& values) {
    auto moved = values;
    for (std::size_t t = 0; t < values.size(); ++t) moved[t] = values[order[t]];
    return moved;
  };
  Scene scene = flat;
  scene.triangles = reordered(flat.triangles);
  scene.triangle_material = reordered(flat.triangle_material);
  scene.triangle_normals = reordered(flat.triangle_normals);
  scene.triangle_uvs = reordered(flat.triangle_uvs);
  scene.triangle_colors = reordered(flat.triangle_colors);
  scene.lights.clear();
  const auto own = static_cast<std::uint32_t>(rest - order.begin());
  for (std::uint32_t t = 0; t < own; ++t) scene.lights.push_back(t);
  const auto count = static_cast<std::uint32_t>(order.end() - rest),
             parts = static_cast<std::uint32_t>(places.size());
  for (std::uint32_t k = 0; k < parts; ++k)
    make_instance(scene, own + k * count / parts, (k + 1) * count / parts - k * count / parts, places[k]);
  return scene;
}

Scene scene_of(const MeshView& mesh) {
  Scene scene;
  scene.triangles.assign(mesh.triangles, mesh.triangles + mesh.count);
  std::uint32_t corners = 0;
  for (const Index3& t : scene.triangles) corners = std::max({corners, t[0] + 1, t[1] + 1, t[2] + 1});
  scene.positions.assign(mesh.positions, mesh.positions + corners);
  scene.materials.emplace_back();
  scene.triangle_material.assign(mesh.count, 0);
  return scene;
}

Scene scene_of(const MeshView& mesh, const std::vector<Transform>& places) {
  Scene scene = scene_of(mesh);
  scene.shared_meshes.push_back({0, mesh.count});
  for (const Transform& place : places)
    scene.instances.push_back(
        {0, {Vec3f(place.rows[0]), Vec3f(place.rows[1]), Vec3f(place.rows[2])}, Vec3f(place.translation)});
  return scene;
}

}  // namespace castray
