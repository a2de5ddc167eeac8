#include "scene/obj_file.h"

#include <fmt/core.h>

#include <charconv>
#include <map>

#include "core/files.h"
#include "core/nearest.h"
#include "core/text.h"
#include "scene/line_reader.h"
#include "scene/mtl_file.h"
#include "scene/polygon.h"

namespace castray {

namespace {

/// A corner of a face: positions in the arrays so far, or none.
struct Corner {
  std::uint32_t position = Scene::no_index, uv = Scene::no_index, normal = Scene::no_index;
};

class ObjReader {
  static constexpr std::size_t most_corners =
      1 << 20;  ///< of a face: bounds what one line can make of memory and time

 public:
  ObjReader(std::string_view text, const std::filesystem::path& file, const ObjOptions& options,
            SceneBuilder& builder)
      : file_(file), options_(options), builder_(builder), lines_(text, file.string()) {}

  Mesh read() {
    while (lines_.next_line()) read_statement();
    return std::move(mesh_);
  }

 private:
  void read_statement() {
    const std::string_view key = lines_.word();
    if (key == "v")
      read_position();
    else if (key == "f")
      read_face();
    else if (key == "vn")
      read_normal();
    else if (key == "vt")
      read_uv();
    else if (key == "usemtl")
      use_material();
    else if (key == "mtllib")
      read_materials();
    // Lines, points, groups, curves: nothing to render.
  }

  Vec3d read_vector(std::string_view key) {
    const double x = lines_.required_number(key);
    const double y = lines_.required_number(key);
    return {x, y, lines_.required_number(key)};
  }

  void read_position() { mesh_.positions.push_back(read_vector("v")); }

  void read_normal() {
    const Vec3d normal = read_vector("vn");
    const double size = length(normal);
    // What is no direction is stored as (0,0,0), and no triangle refers to it.
    mesh_.normals.push_back(size > 0 && std::isfinite(size) ? Vec3f(normal / size) : Vec3f{});
  }

  void read_uv() {
    const double u = lines_.required_number("vt");
    const double v = lines_.number("vt").value_or(0);
    const bool finite = std::isfinite(u) && std::isfinite(v);
    mesh_.uvs.push_back({finite ? static_cast<float>(u) : 0.f, finite ? static_cast<float>(v) : 0.f});
  }

  /// "7" is the seventh, "-1" the last so far.
  std::uint32_t read_index(std::string_view& text, std::size_t count, const char* what) {
    long long index = 0;
    const auto [end, error] = std::from_chars(text.begin(), text.end(), index);
    if (error == std::errc::invalid_argument)
      lines_.fail(fmt::format("'{}' is not a {} index", printable(text), what));
    const auto size = static_cast<long long>(count);
    if (error != std::errc() || index == 0 || index > size || index < -size)
      lines_.fail(fmt::format("{} index {} is out of range: {}", what,
                              printable(text.substr(0, text.find('/'))),
                              count == 0 ? std::string("there is none before this line")
                                         : fmt::format("valid are 1 .. {} and -{} .. -1", count, count)));
    text.remove_prefix(static_cast<std::size_t>(end - text.begin()));
    return static_cast<std::uint32_t>(index > 0 ? index - 1 : size + index);
  }

  /// "v", "v/vt", "v//vn" or "v/vt/vn".
  Corner read_corner(std::string_view text) {
    const std::string_view whole = text;
    Corner corner;
    corner.position = read_index(text, mesh_.positions.size(), "vertex");
    if (text.starts_with('/')) {
      text.remove_prefix(1);
      if (!text.empty() && text.front() != '/')
        corner.uv = read_index(text, mesh_.uvs.size(), "texture coordinate");
      if (text.starts_with('/')) {
        text.remove_prefix(1);
        if (!text.empty()) corner.normal = read_index(text, mesh_.normals.size(), "normal");
      }
    }
    if (!text.empty())
      lines_.fail(fmt::format("'{}' is not a corner; write v, v/vt, v//vn or v/vt/vn", printable(whole)));
    return corner;
  }

  void read_face() {
    corners_.clear();
    for (std::string_view text = lines_.word(); !text.empty(); text = lines_.word()) {
      corners_.push_back(read_corner(text));
      if (corners_.size() > most_corners)
        lines_.fail(fmt::format("a face of more than {} corners; cut it into smaller ones", most_corners));
    }
    if (corners_.size() < 3)
      lines_.fail(fmt::format("a face needs at least 3 corners, but has {}", corners_.size()));
    cuts_.clear();
    if (corners_.size() == 3) {
      cuts_.push_back({0, 1, 2});
    } else {
      outline_.clear();
      for (const Corner& corner : corners_) outline_.push_back(mesh_.positions[corner.position]);
      triangulate(outline_, cuts_);
    }
    for (const Index3& cut : cuts_) add_triangle(corners_[cut[0]], corners_[cut[1]], corners_[cut[2]]);
  }

  bool usable_normal(const Corner& corner) const {
    return corner.normal != Scene::no_index && mesh_.normals[corner.normal] != Vec3f{};
  }

  void add_triangle(const Corner& a, const Corner& b, const Corner& c) {
    const std::size_t before = mesh_.triangles.size();
    mesh_.triangles.push_back({a.position, b.position, c.position});
    mesh_.triangle_material.push_back(material());
    if (options_.read_normals && usable_normal(a) && usable_normal(b) && usable_normal(c)) {
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

  std::uint16_t material() {
    if (options_.material) return *options_.material;
    if (!current_material_) current_material_ = builder_.add_material({.name = "default"});
    return *current_material_;
  }

  void use_material() {
    if (options_.material) return;
    const std::string name(lines_.rest());
    if (name.empty()) lines_.fail("usemtl needs a name");
    const auto found = materials_.find(name);
    if (found == materials_.end()) {
      if (materials_.empty())
        lines_.fail(
            fmt::format("material '{}' not found: no mtllib before this line; name one, or give the mesh a "
                        "\"material\" in a scene file",
                        printable(name)));
      std::vector<std::string_view> known;
      for (const auto& [known_name, index] : materials_) known.push_back(known_name);
      lines_.fail(fmt::format("material '{}' not found{}", printable(name), suggestion(name, known)));
    }
    current_material_ = found->second;
  }

  void read_library(const std::filesystem::path& library) {
    for (std::uint16_t index : read_mtl(library, builder_))
      materials_.emplace(builder_.scene.materials[index].name, index);
  }

  /// "mtllib a.mtl b.mtl" names two files, "mtllib my scene.mtl" one: the longest names that exist are meant.
  void read_materials() {
    std::string_view names = lines_.rest();
    if (options_.material) return;
    if (names.empty()) lines_.fail("mtllib needs a file name");
    while (!names.empty()) {
      std::size_t end = names.size();
      while (!is_file(resolve_path(names.substr(0, end), file_))) {
        end = names.find_last_of(" \t", end - 1);
        if (end == std::string_view::npos || end == 0)
          lines_.fail(
              fmt::format("mtllib: no such file: {}", printable(resolve_path(names, file_).string())));
      }
      read_library(resolve_path(names.substr(0, end), file_));
      names.remove_prefix(end);
      while (!names.empty() && (names.front() == ' ' || names.front() == '\t')) names.remove_prefix(1);
    }
  }

  std::filesystem::path file_;
  ObjOptions options_;
  SceneBuilder& builder_;
  LineReader lines_;
  Mesh mesh_;
  std::optional<std::uint16_t> current_material_;
  std::map<std::string, std::uint16_t> materials_;
  std::vector<Corner> corners_;  // of the face at hand
  std::vector<Vec3d> outline_;
  std::vector<Index3> cuts_;
};

}  // namespace

Mesh parse_obj(std::string_view text, const std::filesystem::path& file, const ObjOptions& options,
               SceneBuilder& builder) {
  return ObjReader(text, file, options, builder).read();
}

Mesh read_obj(const std::filesystem::path& file, const ObjOptions& options, SceneBuilder& builder) {
  return parse_obj(read_file(file), file, options, builder);
}

}  // namespace castray
