#include "scene/ply_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/files.h"
#include "scene/mesh_faces.h"
#include "scene/ply_values.h"
#include "scene/vertex_colors.h"

namespace castray {

namespace {

/// What a property of vertices is, by the names that programs give it.
enum Role : std::size_t { x, y, z, nx, ny, nz, u, v, red, green, blue, roles };
constexpr std::pair<std::string_view, Role> role_names[] = {{"x", x},
                                                            {"y", y},
                                                            {"z", z},
                                                            {"nx", nx},
                                                            {"ny", ny},
                                                            {"nz", nz},
                                                            {"u", u},
                                                            {"v", v},
                                                            {"s", u},
                                                            {"t", v},
                                                            {"texture_u", u},
                                                            {"texture_v", v},
                                                            {"r", red},
                                                            {"g", green},
                                                            {"b", blue},
                                                            {"texture_s", u},
                                                            {"texture_t", v},
                                                            {"red", red},
                                                            {"green", green},
                                                            {"blue", blue},
                                                            {"diffuse_red", red},
                                                            {"diffuse_green", green},
                                                            {"diffuse_blue", blue}};

/// The value that stands for 1 in a colour.
float unit_of_color(PlyType type) {
  if (type >= PlyType::float32) return 1;
  return type == PlyType::uint16 ? 65535.f : 255.f;
}

template <class Values>
class PlyReader {
 public:
  PlyReader(std::string_view bytes, PlyHeader header, const std::filesystem::path& file,
            WarningList& warnings)
      : header_(std::move(header)), file_(file), warnings_(warnings), values_(bytes, header_, file) {
    obj_.path = file;
    obj_.materials.push_back({{}, false, false});
  }

  ObjFile read() {
    const auto vertices = std::ranges::find(header_.elements, "vertex", &PlyElement::name);
    const bool faces_first = vertices != header_.elements.end() &&
                             std::ranges::any_of(header_.elements.begin(), vertices, holds_faces);
    if (faces_first) {  // they name vertices, so these are read before
      const Values start = values_;
      for (const PlyElement& element : header_.elements)
        read_element(element, element.name == "vertex", false);
      values_ = start;
    }
    for (const PlyElement& element : header_.elements) read_element(element, !faces_first, true);
    faces_.warn(warnings_);
    if (header_.texture)
      warnings_.add({file_.string()},
                    "the image of 'comment TextureFile' is not read: give the mesh a material");
    if (!mesh_.colors.empty()) {
      decode_vertex_colors(mesh_, unit_of_color_);
    } else if (triangle_colors_.size() == mesh_.triangles.size()) {
      mesh_.colors = std::move(face_colors_);
      mesh_.triangle_colors = std::move(triangle_colors_);
      decode_colors(mesh_, unit_of_face_color_);
    }
    return std::move(obj_);
  }

 private:
  static bool holds_faces(const PlyElement& element) {
    return element.name == "face" || element.name == "tristrips";
  }

  /// Skips vertices, or faces, where they are not wanted.
  void read_element(const PlyElement& element, bool vertices, bool faces) {
    if (element.properties.empty()) return;
    std::size_t least = 0;
    for (const PlyProperty& p : element.properties) least += Values::bytes_of(p.count.value_or(p.type));
    if (element.count > values_.bytes_left() / least)
      throw InputError(SourcePlace{file_.string()},
                       fmt::format("the file is too short for its {} elements '{}'", element.count,
                                   printable(element.name)));
    if (element.name == "vertex" && vertices) return read_vertices(element);
    const bool wanted = faces && element.name != "vertex";
    find_roles(element, unit_of_face_color_);
    has_face_colors_ = element.name == "face" && has({red, green, blue});
    for (std::uint64_t i = 0; i < element.count; ++i) wanted ? read_lists(element) : skip(element);
  }

  void skip(const PlyElement& element) {
    double ignored = 0;
    for (const PlyProperty& property : element.properties) read_value(property, ignored);
  }

  void read_vertices(const PlyElement& element) {
    if (!mesh_.positions.empty()) values_.fail("a second element 'vertex'");
    if (element.count >= Scene::no_index) values_.fail("more than 2^32 - 2 vertices; use fewer");
    find_roles(element, unit_of_color_);
    if (!has({x, y, z})) values_.fail("the element 'vertex' has no x, y and z");
    has_normals_ = has({nx, ny, nz});
    has_uvs_ = has({u, v});
    const bool has_colors = has({red, green, blue});
    std::array<double, roles + 1> value{};  // the last takes what has no role
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t k = 0; k < role_of_.size(); ++k) read_value(element.properties[k], value[role_of_[k]]);
      mesh_.positions.push_back({value[x], value[y], value[z]});
      if (has_normals_) mesh_.normals.push_back(stored_normal({value[nx], value[ny], value[nz]}));
      if (has_uvs_) add_uv(value[u], value[v]);
      if (has_colors) mesh_.colors.push_back(Vec3f(Vec3d{value[red], value[green], value[blue]}));
    }
  }

  /// Sets the roles of an element's properties, and the value that stands for 1 in its colours.
  void find_roles(const PlyElement& element, float& unit) {
    role_of_.clear();
    for (const PlyProperty& p : element.properties) {
      const auto found = std::ranges::find(role_names, p.name, &std::pair<std::string_view, Role>::first);
      const bool known = !p.count && found != std::end(role_names);
      role_of_.push_back(known ? std::size_t{found->second} : std::size_t{roles});
      if (role_of_.back() == red) unit = unit_of_color(p.type);
    }
  }

  /// Whether the element at hand has all of these.
  bool has(std::initializer_list<Role> wanted) const {
    return std::ranges::all_of(wanted, [&](Role role) { return std::ranges::count(role_of_, role) > 0; });
  }

  void add_uv(double at_u, double at_v) {
    const bool finite = std::isfinite(at_u) && std::isfinite(at_v);
    mesh_.uvs.push_back({finite ? static_cast<float>(at_u) : 0.f, finite ? static_cast<float>(at_v) : 0.f});
  }

  /// A number; of a list, its last.
  void read_value(const PlyProperty& property, double& value) {
    for (std::uint64_t left = property.count ? read_length(property) : 1; left > 0; --left)
      value = values_.next(property.type);
  }

  std::uint64_t read_length(const PlyProperty& property) {
    const double length = values_.next(*property.count);
    if (!(length >= 0 && length <= 0x1p32) || length != std::floor(length))
      values_.fail(fmt::format("{} is not the length of a list", length));
    return static_cast<std::uint64_t>(length);
  }

  /// Faces and strips, and all other elements, whose lists mean nothing here.
  void read_lists(const PlyElement& element) {
    corners_.clear();
    texcoords_.clear();
    std::array<double, roles + 1> value{};
    const bool strips = element.name == "tristrips";
    for (std::size_t k = 0; k < role_of_.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      const bool has_corners = holds_faces(element);
      if (has_corners && property.count &&
          (property.name == "vertex_indices" || property.name == "vertex_index"))
        read_corners(property, strips);
      else if (has_corners && property.count && property.name == "texcoord")
        read_texcoords(property);
      else
        read_value(property, value[role_of_[k]]);
    }
    if (element.name != "face") return;
    add_texcoords();
    faces_.add(corners_, 0);
    if (has_face_colors_) add_face_color({value[red], value[green], value[blue]});
  }

  void add_face_color(const Vec3d& color) {
    const auto i = static_cast<std::uint32_t>(face_colors_.size());
    face_colors_.push_back(Vec3f(color));
    triangle_colors_.resize(mesh_.triangles.size(), {i, i, i});
  }

  void read_corners(const PlyProperty& property, bool strips) {
    const std::uint64_t length = read_length(property);
    if (!strips && length > most_corners)
      values_.fail(fmt::format("a face of more than {} corners; cut it into smaller ones", most_corners));
    for (std::uint64_t i = 0; i < length; ++i) {
      const double index = values_.next(property.type);
      if (strips && index < 0) {
        corners_.clear();
        continue;
      }
      corners_.push_back(corner_at(index));
      if (strips && corners_.size() >= 3) add_of_strip();
    }
  }

  Corner corner_at(double index) const {
    const std::size_t count = mesh_.positions.size();
    if (!(index >= 0 && index < static_cast<double>(count)) || index != std::floor(index))
      values_.fail(count == 0
                       ? fmt::format("vertex index {} is out of range: there is none", index)
                       : fmt::format("vertex index {} is out of range: valid are 0 .. {}", index, count - 1));
    const auto i = static_cast<std::uint32_t>(index);
    return {i, has_uvs_ ? i : Scene::no_index, has_normals_ ? i : Scene::no_index};
  }

  /// The last three corners of a strip; every second triangle is wound the other way.
  void add_of_strip() {
    const std::size_t last = corners_.size() - 1;
    const bool odd = last % 2 == 1;
    const Corner triangle[] = {corners_[last - 2], corners_[odd ? last : last - 1],
                               corners_[odd ? last - 1 : last]};
    faces_.add(triangle, 0);
  }

  void read_texcoords(const PlyProperty& property) {
    for (std::uint64_t left = read_length(property); left > 0; --left)
      if (texcoords_.size() < 2 * most_corners)
        texcoords_.push_back(values_.next(property.type));
      else
        values_.next(property.type);
  }

  /// Those of a face's corners.
  void add_texcoords() {
    if (texcoords_.size() != 2 * corners_.size()) return;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      corners_[i].uv = static_cast<std::uint32_t>(mesh_.uvs.size());
      add_uv(texcoords_[2 * i], texcoords_[2 * i + 1]);
    }
  }

  PlyHeader header_;
  const std::filesystem::path& file_;
  WarningList& warnings_;
  Values values_;
  ObjFile obj_;
  Mesh& mesh_ = obj_.mesh;
  MeshFaces faces_{mesh_, [this] { return values_.place(); }};
  bool has_normals_ = false, has_uvs_ = false;
  std::vector<std::size_t> role_of_;  // of the properties of the element at hand
  float unit_of_color_ = 1, unit_of_face_color_ = 1;
  bool has_face_colors_ = false;
  std::vector<Vec3f> face_colors_;  // in place of those of vertices, where there are none
  std::vector<Index3> triangle_colors_;
  std::vector<Corner> corners_;  // of the face or strip at hand
  std::vector<double> texcoords_;
};

}  // namespace

ObjFile parse_ply(std::string_view bytes, const std::filesystem::path& file, WarningList& warnings) {
  PlyHeader header = read_ply_header(bytes, file, warnings);
  if (header.encoding == PlyEncoding::ascii)
    return PlyReader<PlyTextValues>(bytes, std::move(header), file, warnings).read();
  return PlyReader<PlyBinaryValues>(bytes, std::move(header), file, warnings).read();
}

ObjFile read_ply(const std::filesystem::path& file, WarningList& warnings) {
  return parse_ply(read_file(file), file, warnings);
}

}  // namespace castray
