#include "scene/mesh.h"

#include <algorithm>
#include <cmath>

#include "core/range.h"

namespace castray {

namespace {

/// The same direction, of a length near 1: a power of two is taken out, which rounds nothing.
Vec3d scaled_to_unit(const Vec3d& v) {
  const double most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  const int exponent = most > 0 ? std::ilogb(most) : 0;
  return {std::ldexp(v.x, -exponent), std::ldexp(v.y, -exponent), std::ldexp(v.z, -exponent)};
}

template <class T>
void append_values(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

/// Appends indices moved by `offset`; where only one side has any, the other's triangles get none.
void append_indices(std::vector<Index3>& all, std::size_t triangles, const std::vector<Index3>& more,
                    std::size_t more_triangles, std::size_t offset) {
  if (all.empty() && more.empty()) return;
  all.resize(triangles, no_indices);
  for (Index3 corners : more) {
    for (std::uint32_t& i : corners)
      if (i != Scene::no_index) i += static_cast<std::uint32_t>(offset);
    all.push_back(corners);
  }
  all.resize(triangles + more_triangles, no_indices);
}

template <class T>
void keep_marked(std::vector<T>& values, const std::vector<bool>& keep) {
  if (values.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (keep[i]) values[kept++] = values[i];
  values.resize(kept);
}

/// Moves each object to its first triangle that is kept.
void keep_objects(std::vector<SceneObject>& objects, const std::vector<bool>& keep) {
  auto from = keep.begin();
  std::uint32_t kept = 0;
  for (SceneObject& object : objects) {
    const auto first = keep.begin() + object.first_triangle;
    kept += static_cast<std::uint32_t>(std::count(from, first, true));
    from = first;
    object.first_triangle = kept;
  }
}

}  // namespace

bool is_in_reach(const Vec3d& p) {  // of every corner that is read: no call for each coordinate
  return std::abs(p.x) <= farthest_coordinate && std::abs(p.y) <= farthest_coordinate &&
         std::abs(p.z) <= farthest_coordinate;
}

std::optional<TriangleFault> fault_of(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  if (!is_in_reach(a) || !is_in_reach(b) || !is_in_reach(c)) return TriangleFault::not_finite;
  // Products of tiny edges may vanish though there is an area.
  const bool flat =
      cross(b - a, c - a) == Vec3d{} && cross(scaled_to_unit(b - a), scaled_to_unit(c - a)) == Vec3d{};
  return flat ? std::optional(TriangleFault::no_area) : std::nullopt;
}

void append(Mesh& all, Mesh&& more) {
  if (all.triangles.empty()) {
    all = std::move(more);
    return;
  }
  const std::size_t triangles = all.triangles.size(), added = more.triangles.size();
  append_indices(all.triangle_normals, triangles, more.triangle_normals, added, all.normals.size());
  append_indices(all.triangle_uvs, triangles, more.triangle_uvs, added, all.uvs.size());
  append_indices(all.triangle_colors, triangles, more.triangle_colors, added, all.colors.size());
  append_indices(all.triangles, triangles, more.triangles, added, all.positions.size());
  append_values(all.positions, more.positions);
  append_values(all.normals, more.normals);
  append_values(all.uvs, more.uvs);
  append_values(all.colors, more.colors);
  append_values(all.triangle_material, more.triangle_material);
  for (SceneObject& object : more.objects) {
    object.first_triangle += static_cast<std::uint32_t>(triangles);
    all.objects.push_back(std::move(object));
  }
}

void keep_triangles(Mesh& mesh, const std::vector<bool>& keep) {
  if (std::ranges::find(keep, false) == keep.end()) return;
  keep_objects(mesh.objects, keep);
  keep_marked(mesh.triangles, keep);
  keep_marked(mesh.triangle_material, keep);
  keep_marked(mesh.triangle_normals, keep);
  keep_marked(mesh.triangle_uvs, keep);
  keep_marked(mesh.triangle_colors, keep);
}

}  // namespace castray
