#include "geometry/facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "core/error_bounds.h"

namespace castray {

namespace {

using Corners = std::vector<Vec3d>;

constexpr double coplanar_tolerance =
    0x1p-23;  ///< distance from the plane, scene space: what rounding to float leaves
constexpr double ulp = 0x1p-24;

Vec3d unit_normal(const Corners& c) { return normalize(cross(c[1] - c[0], c[2] - c[0])); }

double distance_to_plane(const Corners& c, const Vec3d& p) { return std::abs(dot(unit_normal(c), p - c[0])); }

bool is_convex(const Corners& c) {
  const Vec3d n = unit_normal(c);
  for (std::size_t k = 0; k < c.size(); ++k) {
    const Vec3d along = c[(k + 1) % c.size()] - c[k], next = c[(k + 2) % c.size()] - c[(k + 1) % c.size()];
    if (dot(cross(along, next), n) <= 0) return false;
  }
  return true;
}

Corners corners_of(const Scene& scene, std::uint32_t triangle) {
  Corners corners;
  for (std::uint32_t v : scene.triangles[triangle]) corners.push_back(Vec3d(scene.positions[v]));
  return corners;
}

/// The quad of two triangles that share an edge with opposite directions, in the first one's orientation.
std::optional<Corners> merged(const Corners& a, const Corners& b) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (a[i] == b[(j + 1) % 3] && a[(i + 1) % 3] == b[j]) {
        const Corners quad{a[i], b[(j + 2) % 3], a[(i + 1) % 3], a[(i + 2) % 3]};
        const bool flat = distance_to_plane(a, b[(j + 2) % 3]) <= coplanar_tolerance &&
                          distance_to_plane(b, a[(i + 2) % 3]) <= coplanar_tolerance;
        if (flat && is_convex(quad)) return quad;
      }
  return std::nullopt;
}

int largest_axis(const Vec3d& n) {
  const Vec3d a{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  return a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
}

int axis_of(const Facet& f) { return largest_axis({f.normal[0], f.normal[1], f.normal[2]}); }

/// How far the exact facet can be from the rounded plane, plus the rounding of a point computed on that
/// plane: a dot product of three terms and an offset, a scaled step along the normal, and the final sum
/// (gamma(8) at most). Tests of visibility round as much in proportion to the scene, which is within 1 of its
/// middle: what starts or ends off the facet by this is on the right side of it for them too.
double plane_error(const Facet& f, const Corners& corners) {
  const Vec3d n{f.normal[0], f.normal[1], f.normal[2]};
  double error = 0, size = std::abs(f.offset);
  for (const Vec3d& p : corners) {
    error = std::max(error, std::abs(dot(n, p) - f.offset));
    size = std::max(size, std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
  }
  return error + 8 * ulp * (size + 2);
}

Facet make_facet(const Corners& corners, std::uint32_t material, std::uint32_t first, std::uint32_t second) {
  Facet f{};
  const Vec3d n = unit_normal(corners);
  double offset = 0;
  for (const Vec3d& p : corners) offset += dot(n, p) / static_cast<double>(corners.size());
  for (int c = 0; c < 3; ++c) f.normal[c] = static_cast<float>(n[c]);
  f.offset = static_cast<float>(offset);
  const int axis = axis_of(f), u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double side = n[axis] > 0 ? 1 : -1;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3d& a = corners[k % corners.size()];
    const Vec3d& b = corners[(k + 1) % corners.size()];
    const double du = b[u] - a[u], dv = b[v] - a[v], scale = side / std::hypot(du, dv);
    f.edge[k][0] = static_cast<float>(-dv * scale);
    f.edge[k][1] = static_cast<float>(du * scale);
    f.edge[k][2] = static_cast<float>((dv * a[u] - du * a[v]) * scale);
    for (int c = 0; c < 3; ++c) f.corner[k][c] = static_cast<float>(a[c]);
  }
  f.error = static_cast<float>(plane_error(f, corners));
  f.material = material;
  f.triangle[0] = first;
  f.triangle[1] = second;
  return f;
}

/// An undirected edge between two positions.
using EdgeKey = std::array<float, 6>;
EdgeKey edge_key(const Vec3f& a, const Vec3f& b) {
  EdgeKey forward{a.x, a.y, a.z, b.x, b.y, b.z}, backward{b.x, b.y, b.z, a.x, a.y, a.z};
  return std::min(forward, backward);
}

/// Facets of the given triangles, each merged with the first later neighbour that it forms a quad with; not
/// where an image says what they emit, as that depends on the triangle.
std::vector<Facet> merge_triangles(const Scene& scene, const std::vector<std::uint32_t>& triangles) {
  std::vector<Facet> facets;
  std::multimap<EdgeKey, std::uint32_t> waiting;  // triangles without a partner, by their edges
  std::vector<std::uint32_t> partner(triangles.size(), Scene::no_index);
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Corners corners = corners_of(scene, triangles[i]);
    const Index3& index = scene.triangles[triangles[i]];
    for (std::size_t k = 0; k < 3 && partner[i] == Scene::no_index; ++k) {
      const auto [begin, end] =
          waiting.equal_range(edge_key(scene.positions[index[k]], scene.positions[index[(k + 1) % 3]]));
      for (auto it = begin; it != end; ++it) {
        const std::uint32_t j = it->second;
        const bool same_material =
            scene.triangle_material[triangles[j]] == scene.triangle_material[triangles[i]];
        const bool has_image =
            std::ranges::any_of(scene.emitting_sides(scene.triangle_material[triangles[i]]),
                                [&](std::uint16_t side) { return scene.materials[side].has_emission_map(); });
        if (partner[j] == Scene::no_index && same_material && !has_image &&
            merged(corners_of(scene, triangles[j]), corners)) {
          partner[i] = j;
          partner[j] = i;
          break;
        }
      }
    }
    for (std::size_t k = 0; k < 3 && partner[i] == Scene::no_index; ++k)
      waiting.emplace(edge_key(scene.positions[index[k]], scene.positions[index[(k + 1) % 3]]), i);
  }
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t first = triangles[i];
    const std::uint16_t material = scene.triangle_material[first];
    if (partner[i] == Scene::no_index)
      facets.push_back(make_facet(corners_of(scene, first), material, first, first));
    else if (partner[i] > i)
      facets.push_back(make_facet(*merged(corners_of(scene, first), corners_of(scene, triangles[partner[i]])),
                                  material, first, triangles[partner[i]]));
  }
  std::stable_sort(facets.begin(), facets.end(), [](auto& a, auto& b) { return axis_of(a) < axis_of(b); });
  return facets;
}

/// Whether some of the scene, an environment that shines, or a light without size, which may be anywhere,
/// lies behind the facet as seen from other parts of the scene.
bool can_block(const Facet& f, const Scene& scene) {
  if (max_component(scene.environment) > 0 || !scene.delta_lights.empty()) return true;
  const Vec3d n{f.normal[0], f.normal[1], f.normal[2]};
  double below = 0, above = 0;
  for (const Vec3f& p : scene.positions) {
    const double distance = dot(n, Vec3d(p)) - f.offset;
    below = std::min(below, distance);
    above = std::max(above, distance);
  }
  return below < -f.error && above > f.error;
}

/// How far a point on a light of triangles may be from where a ray/triangle test finds it: the rounding of an
/// interpolated point and what the test itself errs from there (see point_on_triangle in
/// core/error_bounds.h). Unlike that of a facet it does not grow with the scene.
double light_error(const Facet& f) {
  Corners corners;
  for (const auto& c : f.corner) corners.push_back({c[0], c[1], c[2]});
  const Vec3d n{f.normal[0], f.normal[1], f.normal[2]};
  double deviation = 0, extent = 0;
  Vec3d size;
  for (const Vec3d& p : corners) {
    deviation = std::max(deviation, distance_to_plane(corners, p));
    extent = std::max(extent, max_component(magnitude(p - corners[0])));
    for (int c = 0; c < 3; ++c) size[c] = std::max(size[c], std::abs(p[c]));
  }
  return deviation + dot(magnitude(n), size * (9 * ulp) + Vec3d(error_of_test(static_cast<float>(extent))));
}

FacetList view(const std::vector<Facet>& facets) {
  FacetList list{facets.data(), {}, {}};
  for (const Facet& f : facets)
    for (int axis = axis_of(f); axis < 3; ++axis) ++list.first[axis + 1];
  return list;
}

}  // namespace

FacetList Facets::list() const { return view(facets); }
FacetList Facets::blocker_list() const { return view(blockers); }

BlockerList Facets::blocker_field_list() const {
  BlockerList list{};
  list.count = static_cast<std::uint32_t>(blockers.size());
  list.padded = (list.count + 15) / 16 * 16;
  const float* next = blocker_fields.data();
  const auto point_to_next = [&](const float*& field) {
    field = next;
    next += list.padded;
  };
  for (auto& corner : list.corner)
    for (const float*& component : corner) point_to_next(component);
  for (const float*& component : list.center) point_to_next(component);
  point_to_next(list.radius);
  return list;
}

namespace {

/// The middle of a facet's corners, and the radius of a ball around it that holds them.
std::array<float, 4> ball_around(const Facet& f) {
  Vec3d middle;
  for (const auto& c : f.corner) middle += Vec3d(c[0], c[1], c[2]) / 4.0;
  double radius = 0;
  for (const auto& c : f.corner) radius = std::max(radius, length(Vec3d(c[0], c[1], c[2]) - middle));
  constexpr double rounding = 1 + 0x1p-20;
  return {static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z),
          static_cast<float>(radius * rounding)};
}

}  // namespace

Facets make_facets(const Scene& scene) {
  Facets result;
  std::vector<std::uint32_t> all(scene.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  result.facets = merge_triangles(scene, all);
  for (const Facet& f : result.facets)
    if (can_block(f, scene)) result.blockers.push_back(f);
  const std::size_t padded = (result.blockers.size() + 15) / 16 * 16;
  constexpr std::size_t coordinates = 12, fields = coordinates + 4;
  for (std::size_t field = 0; field < fields; ++field)
    for (std::size_t i = 0; i < padded; ++i) {
      const Facet& f = result.blockers[std::min(i, result.blockers.size() - 1)];
      result.blocker_fields.push_back(field < coordinates ? f.corner[field / 3][field % 3]
                                                          : ball_around(f)[field - coordinates]);
    }
  return result;
}

FacetsInDouble::FacetsInDouble(const Scene& scene, const std::vector<Facet>& facets)
    : triangles_(mesh_of(scene)), facet_of_(scene.triangles.size()) {
  for (std::uint32_t i = 0; i < facets.size(); ++i)
    for (const std::uint32_t triangle : facets[i].triangle) facet_of_[triangle] = i;
}

namespace {

Ray<double> ray_of(const float origin[3], const float direction[3]) {
  return {{origin[0], origin[1], origin[2]}, {direction[0], direction[1], direction[2]}};
}

}  // namespace

void FacetsInDouble::closest(const void* self, const float origin[3], const float direction[3], float& t,
                             std::uint32_t& facet) {
  const auto& facets = *static_cast<const FacetsInDouble*>(self);
  const Hit<double> hit = facets.triangles_.closest(ray_of(origin, direction));
  t = static_cast<float>(hit.t);
  facet = hit.found() ? facets.facet_of_[hit.triangle] : Scene::no_index;
}

bool FacetsInDouble::occluded(const void* self, const float origin[3], const float direction[3]) {
  Ray<double> segment = ray_of(origin, direction);
  segment.t_max = 1;
  return static_cast<const FacetsInDouble*>(self)->triangles_.occluded(segment);
}

std::vector<Facet> emitting_facets(const Scene& scene) {
  std::vector<Facet> facets = merge_triangles(scene, scene.lights);
  for (Facet& f : facets) f.error = static_cast<float>(light_error(f));
  return facets;
}

}  // namespace castray
