#include "scene/obj_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <unordered_map>

#include "core/files.h"
#include "core/text.h"
#include "scene/line_reader.h"
#include "scene/mesh_faces.h"
#include "scene/vertex_colors.h"

namespace castray {

namespace {

/// What may be odd about a great many lines.
enum class Oddity : unsigned char { uv_index_0, normal_index_0, no_uvs, no_normals, capitals };
constexpr const char* oddities[] = {
    "texture coordinate index 0 is read as none",
    "normal index 0 is read as none",
    "a face names texture coordinates, but there are none before it; it gets none",
    "a face names normals, but there are none before it; it gets none",
    "a statement in capitals means nothing; write v, vn, vt and f",
};

/// A face names what has not come yet.
struct FacesFirst {};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::filesystem::path& file, WarningList& warnings)
      : warnings_(warnings), lines_(text, file.string()) {
    obj_.path = file;
  }

  /// Reads the vertices of all lines, for files whose faces come first; `read` does the rest.
  void read_vertices() {
    const LineReader start = lines_;
    while (lines_.next_line()) read_vertex(lines_.word());
    lines_ = start;
    so_far_ = {};
    vertices_are_read_ = true;
  }

  /// Throws FacesFirst where a face comes before its vertices, unless these are read.
  ObjFile read() {
    while (lines_.next_line()) read_statement();
    if (const Met& capitals = odd_[static_cast<std::size_t>(Oddity::capitals)];
        mesh_.triangles.empty() && capitals.count > 0)
      throw InputError(capitals.place, oddities[static_cast<std::size_t>(Oddity::capitals)]);
    store_smoothing();
    finish_colors();
    for (std::size_t i = 0; i < std::size(oddities); ++i)
      if (odd_[i].count > 0) warnings_.add(odd_[i].place, oddities[i], Harm::changes_picture, odd_[i].count);
    faces_.warn(warnings_);
    return std::move(obj_);
  }

 private:
  void read_statement() {
    const std::string_view key = lines_.word();
    if (key == "f" || key == "fo")  // "fo" in files of old
      read_face();
    else if (key.starts_with('v'))
      vertices_are_read_ ? count_vertex(key) : read_vertex(key);
    else if (key == "s")
      read_smoothing();
    else if (key == "usemtl")
      use_material();
    else if (key == "mtllib")
      read_libraries();
    else if (key == "o" || (key == "g" && !names_objects_))
      begin_object(key == "o");
    else if (key == "V" || key == "F" || key == "VN" || key == "VT")
      note(Oddity::capitals);
    // Lines, points, curves: nothing to render.
  }

  void read_vertex(std::string_view key) {
    if (key == "v")
      read_position();
    else if (key == "vn")
      read_normal();
    else if (key == "vt")
      read_uv();
    count_vertex(key);
  }

  void count_vertex(std::string_view key) {
    so_far_.positions += key == "v";
    so_far_.normals += key == "vn";
    so_far_.uvs += key == "vt";
  }

  /// Groups stand for objects in files that name none.
  void begin_object(bool named) {
    if (named && !names_objects_) mesh_.objects.clear();
    names_objects_ |= named;
    mesh_.objects.push_back({std::string(lines_.rest()), static_cast<std::uint32_t>(mesh_.triangles.size())});
  }

  void note(Oddity oddity) {
    Met& met = odd_[static_cast<std::size_t>(oddity)];
    if (met.count++ == 0) met.place = lines_.place();
  }

  Vec3d read_vector(std::string_view key) {
    const double x = lines_.required_number(key);
    const double y = lines_.required_number(key);
    return {x, y, lines_.required_number(key)};
  }

  /// "v x y z", "v x y z w", "v x y z r g b" or, rarely, "v x y z r g b a".
  void read_position() {
    mesh_.positions.push_back(read_vector("v"));
    if (lines_.at_end() && mesh_.colors.empty()) return;
    std::array<double, 4> more{};
    std::size_t count = 0;
    for (; count < more.size(); ++count) {
      const std::optional<double> number = parse_number(lines_.word());
      if (!number) break;
      more[count] = *number;
    }
    const bool colored = count >= 3;
    if (!colored && mesh_.colors.empty()) return;
    mesh_.colors.resize(mesh_.positions.size(), no_color);
    if (colored) mesh_.colors.back() = Vec3f(Vec3d{more[0], more[1], more[2]});
  }

  /// Colours as programs store them: by the curve of sRGB, in 0 .. 1 or, where any is greater, in 0 .. 255.
  void finish_colors() {
    if (mesh_.colors.empty()) return;
    mesh_.colors.resize(mesh_.positions.size(), no_color);
    float greatest = 0;
    for (const Vec3f& color : mesh_.colors) greatest = std::max(greatest, max_component(color));
    const float unit = greatest > 1 ? 255.f : 1.f;
    for (Vec3f& color : mesh_.colors)
      if (color == no_color) color = Vec3f(unit);
    decode_vertex_colors(mesh_, unit);
  }
  static constexpr Vec3f no_color{-1, -1, -1};  ///< of a vertex without one: white

  void read_normal() { mesh_.normals.push_back(stored_normal(read_vector("vn"))); }

  void read_uv() {
    const double u = lines_.required_number("vt");
    const double v = lines_.number("vt").value_or(0);
    const bool finite = std::isfinite(u) && std::isfinite(v);
    mesh_.uvs.push_back({finite ? static_cast<float>(u) : 0.f, finite ? static_cast<float>(v) : 0.f});
  }

  /// "s 1", "s off", "s 0": of the faces that follow.
  void read_smoothing() {
    const std::string_view group = lines_.word();
    const std::optional<double> number = parse_number(group);
    constexpr std::uint32_t greatest = std::numeric_limits<std::uint32_t>::max();
    const bool in_range = number && *number >= 0 && *number <= greatest;
    store_smoothing();
    smoothing_ = in_range ? static_cast<std::uint32_t>(*number) : group == "on" ? 1 : 0;
    if (smoothing_ != 0) obj_.smoothing.resize(mesh_.triangles.size());
  }

  /// Of the triangles so far; while all are in none, nothing is stored.
  void store_smoothing() {
    if (smoothing_ != 0 || !obj_.smoothing.empty()) obj_.smoothing.resize(mesh_.triangles.size(), smoothing_);
  }

  /// The index at the front of `text`, as it is written; takes it off.
  long long read_written_index(std::string_view& text, const char* what) {
    long long index = 0;
    const auto [end, error] = std::from_chars(text.begin(), text.end(), index);
    if (error == std::errc::invalid_argument)
      lines_.fail(fmt::format("'{}' is not a {} index", printable(text), what));
    if (error != std::errc()) index = std::numeric_limits<long long>::max();
    text.remove_prefix(static_cast<std::size_t>(end - text.begin()));
    return index;
  }

  /// "7" is the seventh of the file, "-1" the last of `so_far`.
  std::uint32_t read_index(std::string_view& text, std::size_t count, std::size_t so_far, const char* what) {
    const std::string_view written = text;
    const long long index = read_written_index(text, what);
    const auto size = static_cast<long long>(count), before = static_cast<long long>(so_far);
    if (index > size && !vertices_are_read_) throw FacesFirst{};
    if (index == 0 || index > size || index < -before)
      lines_.fail(fmt::format("{} index {} is out of range: {}", what,
                              printable(written.substr(0, written.find('/'))), valid_indices(count, so_far)));
    return static_cast<std::uint32_t>(index > 0 ? index - 1 : before + index);
  }

  static std::string valid_indices(std::size_t count, std::size_t so_far) {
    if (count == 0) return "the file has none";
    const std::string all = fmt::format("valid are 1 .. {}", count);
    return so_far == 0 ? all : all + fmt::format(" and -{} .. -1", so_far);
  }

  /// The same, or none: where it is 0, or the file has none of the kind.
  std::uint32_t read_optional_index(std::string_view& text, std::size_t count, std::size_t so_far,
                                    const char* what, Oddity zero, Oddity none) {
    std::string_view after = text;
    const long long index = read_written_index(after, what);
    const bool may_come = index > 0 && !vertices_are_read_;
    if (index != 0 && (count != 0 || may_come)) return read_index(text, count, so_far, what);
    text = after;
    note(index == 0 ? zero : none);
    return Scene::no_index;
  }

  /// "v", "v/vt", "v//vn" or "v/vt/vn".
  Corner read_corner(std::string_view text) {
    const std::string_view whole = text;
    Corner corner;
    corner.position = read_index(text, mesh_.positions.size(), so_far_.positions, "vertex");
    if (text.starts_with('/')) {
      text.remove_prefix(1);
      if (!text.empty() && text.front() != '/')
        corner.uv = read_optional_index(text, mesh_.uvs.size(), so_far_.uvs, "texture coordinate",
                                        Oddity::uv_index_0, Oddity::no_uvs);
      if (text.starts_with('/')) {
        text.remove_prefix(1);
        if (!text.empty())
          corner.normal = read_optional_index(text, mesh_.normals.size(), so_far_.normals, "normal",
                                              Oddity::normal_index_0, Oddity::no_normals);
      }
    }
    if (!text.empty())
      lines_.fail(fmt::format("'{}' is not a corner; write v, v/vt, v//vn or v/vt/vn", printable(whole)));
    return corner;
  }

  void read_face() {
    corners_.clear();
    lost_corner_.reset();
    for (std::string_view text = lines_.word(); !text.empty(); text = lines_.word()) {
      corners_.push_back(read_corner(text));
      if (!lost_corner_ && !is_in_reach(mesh_.positions[corners_.back().position]))
        lost_corner_ = lines_.word_place();
      if (corners_.size() > most_corners)
        lines_.fail(fmt::format("a face of more than {} corners; cut it into smaller ones", most_corners));
    }
    faces_.add(corners_, corners_.size() < 3 ? std::uint16_t{} : current_material());
  }

  void use_material() {
    current_ = {{std::string(lines_.rest()), lines_.place()}, true, obj_.libraries.empty()};
    current_index_.reset();
  }

  /// The position in `materials` of the one that was named last; it is there once a triangle needs it.
  std::uint16_t current_material() {
    if (current_index_) return *current_index_;
    const auto [found, is_new] =
        material_indices_.try_emplace(current_.named ? "usemtl " + current_.name : "", obj_.materials.size());
    if (is_new) {
      constexpr std::size_t most = std::numeric_limits<std::uint16_t>::max();
      if (obj_.materials.size() >= most) lines_.fail(fmt::format("more than {} materials; use fewer", most));
      obj_.materials.push_back(current_);
    }
    current_index_ = static_cast<std::uint16_t>(found->second);
    return *current_index_;
  }

  void read_libraries() {
    const std::string_view names = lines_.rest();
    obj_.libraries.push_back({std::string(names), lines_.place()});
  }

  /// Of each kind, before the line at hand.
  struct VertexCounts {
    std::size_t positions = 0, normals = 0, uvs = 0;
  };

  /// Where an oddity is met first, and how often.
  struct Met {
    SourcePlace place;
    std::uint64_t count = 0;
  };

  WarningList& warnings_;
  Met odd_[std::size(oddities)];
  LineReader lines_;
  ObjFile obj_;
  Mesh& mesh_ = obj_.mesh;
  MeshFaces faces_{mesh_, [this] { return lost_corner_.value_or(lines_.place()); }};
  VertexCounts so_far_;
  bool vertices_are_read_ = false;
  bool names_objects_ = false;
  std::uint32_t smoothing_ = 0;  // the group of the faces at hand
  ObjFile::UsedMaterial current_{{}, false, false};
  std::optional<std::uint16_t> current_index_;
  std::unordered_map<std::string, std::size_t> material_indices_;
  std::vector<Corner> corners_;             // of the face at hand
  std::optional<SourcePlace> lost_corner_;  // likewise, the first that is out of reach
};

}  // namespace

ObjFile parse_obj(std::string_view text, const std::filesystem::path& file, WarningList& warnings) {
  try {
    return ObjReader(text, file, warnings).read();
  } catch (const FacesFirst&) {
    ObjReader reader(text, file, warnings);
    reader.read_vertices();
    return reader.read();
  }
}

ObjFile read_obj(const std::filesystem::path& file, WarningList& warnings) {
  return parse_obj(read_file(file), file, warnings);
}

}  // namespace castray
