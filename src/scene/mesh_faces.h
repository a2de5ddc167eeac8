#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/mesh.h"
#include "scene/polygon.h"
#include "scene/warning_list.h"

namespace castray {

/// A corner of a face: indices into a mesh's arrays, Scene::no_index where it has none.
struct Corner {
  std::uint32_t position = 0, uv = Scene::no_index, normal = Scene::no_index;
};

/// The greatest number of corners that a face may have.
inline constexpr std::size_t most_corners = 1u << 20;

/// Adds faces to a mesh, of whichever file: polygons are cut, triangles turned whose vertex normals say that
/// they are wound the other way, and what is odd is noted.
class MeshFaces {
 public:
  /// `place` tells where in the file the face is that is being added.
  MeshFaces(Mesh& mesh, std::function<SourcePlace()> place) : mesh_(mesh), place_(std::move(place)) {}

  /// Adds a face; one of fewer than 3 corners is left out.
  void add(std::span<const Corner> corners, std::uint16_t material) {
    if (corners.size() < 3) return note(few_corners_);
    if (corners.size() == 3) return add_triangle(corners[0], corners[1], corners[2], material);
    outline_.clear();
    for (const Corner& corner : corners) outline_.push_back(mesh_.positions[corner.position]);
    cuts_.clear();
    triangulate(outline_, cuts_);
    for (const Index3& cut : cuts_) add_triangle(corners[cut[0]], corners[cut[1]], corners[cut[2]], material);
  }

  /// Warns of odd faces. `of` is put in front of the messages.
  void warn(WarningList& warnings, const std::string& of = "") const {
    const auto add = [&](const Met& met, const char* what) {
      if (met.count > 0) warnings.add(met.place, of + what, Harm::changes_picture, met.count);
    };
    add(few_corners_, "a face of fewer than 3 corners is left out");
    add(turned_, "a triangle's three normals oppose the order of its corners, which is turned round");
  }

 private:
  /// Where something is met first, and how often.
  struct Met {
    SourcePlace place;
    std::uint64_t count = 0;
  };

  void note(Met& met) {
    if (met.count++ == 0) met.place = place_();
  }

  void note_fault(const Corner& a, const Corner& b, const Corner& c) {
    const auto fault =
        fault_of(mesh_.positions[a.position], mesh_.positions[b.position], mesh_.positions[c.position]);
    if (!fault) return;
    SourcePlace& first = mesh_.first_faults[static_cast<std::size_t>(*fault)];
    if (first.file.empty()) first = place_();
  }

  bool usable_normal(const Corner& corner) const {
    return corner.normal != Scene::no_index && mesh_.normals[corner.normal] != Vec3f{};
  }

  /// Vertex normals say which side is outward, where all three agree against the order of the corners.
  bool is_wound_against_normals(const Corner& a, const Corner& b, const Corner& c) const {
    const Vec3d& origin = mesh_.positions[a.position];
    const Vec3d winding = cross(mesh_.positions[b.position] - origin, mesh_.positions[c.position] - origin);
    const auto opposes = [&](const Corner& corner) {
      return dot(Vec3d(mesh_.normals[corner.normal]), winding) < 0;
    };
    return opposes(a) && opposes(b) && opposes(c);
  }

  void add_triangle(const Corner& a, Corner b, Corner c, std::uint16_t material) {
    note_fault(a, b, c);
    const std::size_t before = mesh_.triangles.size();
    const bool has_normals = usable_normal(a) && usable_normal(b) && usable_normal(c);
    if (has_normals && is_wound_against_normals(a, b, c)) {
      note(turned_);
      std::swap(b, c);
    }
    mesh_.triangles.push_back({a.position, b.position, c.position});
    mesh_.triangle_material.push_back(material);
    if (has_normals) {
      mesh_.triangle_normals.resize(before, no_indices);
      mesh_.triangle_normals.push_back({a.normal, b.normal, c.normal});
    } else if (!mesh_.triangle_normals.empty()) {
      mesh_.triangle_normals.push_back(no_indices);
    }
    if (a.uv != Scene::no_index && b.uv != Scene::no_index && c.uv != Scene::no_index) {
      mesh_.triangle_uvs.resize(before, no_indices);
      mesh_.triangle_uvs.push_back({a.uv, b.uv, c.uv});
    } else if (!mesh_.triangle_uvs.empty()) {
      mesh_.triangle_uvs.push_back(no_indices);
    }
  }

  Mesh& mesh_;
  std::function<SourcePlace()> place_;
  Met few_corners_, turned_;
  std::vector<Vec3d> outline_;  // of the face at hand
  std::vector<Index3> cuts_;
};

/// A vertex normal as meshes hold it: unit, or (0,0,0) for what is no direction, to which no triangle refers.
inline Vec3f stored_normal(const Vec3d& normal) {
  const double size = length(normal);
  return size > 0 && std::isfinite(size) ? Vec3f(normal / size) : Vec3f{};
}

}  // namespace castray
