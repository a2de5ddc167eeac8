#include "scene/smooth_normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <unordered_map>

namespace castray {

namespace {

struct PlaceHash {
  std::size_t operator()(const Vec3d& p) const {
    std::size_t hash = 0;
    for (const double x : {p.x, p.y, p.z}) hash = (hash ^ std::hash<double>()(x)) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 32);
  }
};

/// For each vertex the first one at its place.
std::vector<std::uint32_t> weld(const std::vector<Vec3d>& positions) {
  std::unordered_map<Vec3d, std::uint32_t, PlaceHash> first;
  first.reserve(positions.size());
  std::vector<std::uint32_t> welded(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i)
    welded[i] = first.try_emplace(positions[i], i).first->second;
  return welded;
}

/// The corners of triangles, 3 t + i, by vertex.
struct CornersOfVertices {
  std::vector<std::uint32_t> begin, corners;  ///< those of v: corners[begin[v]] .. corners[begin[v + 1]]

  CornersOfVertices(const Mesh& mesh, const std::vector<std::uint32_t>& welded)
      : begin(mesh.positions.size() + 1), corners(3 * mesh.triangles.size()) {
    for (const Index3& t : mesh.triangles)
      for (const std::uint32_t v : t) ++begin[welded[v] + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::uint32_t i = 0; i < 3; ++i) corners[next[welded[mesh.triangles[t][i]]]++] = 3 * t + i;
  }
};

/// A face as its three corners' normals see it.
struct Face {
  Vec3f normal;  ///< of unit length, or (0,0,0)
  std::array<float, 3> angles{};
};

Face make_face(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d edges[3] = {b - a, c - b, a - c};
  const Vec3d area = cross(edges[0], edges[1]);
  const double size = length(area);
  if (!(size > 0) || !std::isfinite(size)) return {};
  Face face{Vec3f(area / size)};
  for (std::size_t i = 0; i < 3; ++i)
    face.angles[i] = static_cast<float>(std::atan2(size, -dot(edges[i], edges[(i + 2) % 3])));
  return face;
}

class Smoother {
 public:
  Smoother(const Mesh& mesh, const std::vector<std::uint32_t>& groups, double crease_angle)
      : groups_(groups), least_cosine_(std::cos(crease_angle * std::numbers::pi / 180) - 1e-6) {
    faces_.reserve(mesh.triangles.size());
    for (const Index3& t : mesh.triangles)
      faces_.push_back(make_face(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
    creased_ = crease_angle < 180;
  }

  /// Appends the normals of one vertex and sets its corners' indices.
  void smooth(std::span<const std::uint32_t> corners, Mesh& mesh) {
    constexpr std::size_t most_with_creases = 256;  // each corner then looks at every other
    const bool creased = creased_ && corners.size() <= most_with_creases;
    const std::size_t first = mesh.normals.size();
    of_groups_.clear();
    for (const std::uint32_t corner : corners) {
      const std::uint32_t group = group_of(corner / 3);
      if (!groups_.empty() && group == 0) continue;
      mesh.triangle_normals[corner / 3][corner % 3] =
          creased ? add(mean(corners, corner, true), first, mesh) : of_group(group, corners, corner, mesh);
    }
  }

 private:
  std::uint32_t group_of(std::uint32_t triangle) const { return groups_.empty() ? 0 : groups_[triangle]; }

  Vec3f mean(std::span<const std::uint32_t> corners, std::uint32_t own, bool creased) const {
    const Face& face = faces_[own / 3];
    Vec3d sum;
    for (const std::uint32_t corner : corners) {
      const Face& other = faces_[corner / 3];
      if (group_of(corner / 3) != group_of(own / 3)) continue;
      if (creased && dot(Vec3d(face.normal), Vec3d(other.normal)) < least_cosine_) continue;
      sum += Vec3d(other.normal) * static_cast<double>(other.angles[corner % 3]);
    }
    const double size = length(sum);
    return size > 1e-6 ? Vec3f(sum / size) : face.normal;
  }

  /// The normal that all corners of a group share.
  std::uint32_t of_group(std::uint32_t group, std::span<const std::uint32_t> corners, std::uint32_t corner,
                         Mesh& mesh) {
    const auto found = std::ranges::find(of_groups_, group, &GroupNormal::group);
    if (found != of_groups_.end()) return found->normal;
    of_groups_.push_back({group, add(mean(corners, corner, false), mesh.normals.size(), mesh)});
    return of_groups_.back().normal;
  }

  /// The position of a normal in the mesh, where it may be one of those from `first` on.
  static std::uint32_t add(const Vec3f& normal, std::size_t first, Mesh& mesh) {
    const auto begin = mesh.normals.begin() + static_cast<std::ptrdiff_t>(first);
    const auto found = std::find(begin, mesh.normals.end(), normal);
    const auto index = static_cast<std::uint32_t>(found - mesh.normals.begin());
    if (found == mesh.normals.end()) mesh.normals.push_back(normal);
    return index;
  }

  struct GroupNormal {
    std::uint32_t group, normal;
  };

  const std::vector<std::uint32_t>& groups_;
  double least_cosine_;
  bool creased_ = false;
  std::vector<Face> faces_;
  std::vector<GroupNormal> of_groups_;  ///< of the vertex at hand
};

}  // namespace

void smooth_normals(Mesh& mesh, const std::vector<std::uint32_t>& groups, double crease_angle) {
  Smoother smoother(mesh, groups, crease_angle);
  const CornersOfVertices vertices(mesh, weld(mesh.positions));
  mesh.normals.clear();
  mesh.triangle_normals.assign(mesh.triangles.size(), no_indices);
  for (std::size_t v = 0; v + 1 < vertices.begin.size(); ++v)
    smoother.smooth(
        std::span(vertices.corners).subspan(vertices.begin[v], vertices.begin[v + 1] - vertices.begin[v]),
        mesh);
  // A flat normal that a degenerate face left at a corner is no direction.
  for (Index3& t : mesh.triangle_normals)
    if (std::ranges::any_of(
            t, [&](std::uint32_t i) { return i == Scene::no_index || mesh.normals[i] == Vec3f{}; }))
      t = no_indices;
}

}  // namespace castray
