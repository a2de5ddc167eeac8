#include "scene/mtl_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "core/files.h"
#include "core/range.h"
#include "core/text.h"
#include "scene/line_reader.h"
#include "scene/names.h"

namespace castray {

namespace {

constexpr double no_limit = std::numeric_limits<double>::max();

struct ColorKey {
  std::string_view key;
  std::optional<Vec3d> MtlMaterial::*color;
  double greatest;
};
constexpr ColorKey color_keys[] = {{"kd", &MtlMaterial::kd, 1},
                                   {"ks", &MtlMaterial::ks, 1},
                                   {"ke", &MtlMaterial::ke, no_limit},
                                   {"tf", &MtlMaterial::tf, 1}};

struct NumberKey {
  std::string_view key;
  std::optional<double> MtlMaterial::*number;
  double greatest;
};
constexpr NumberKey number_keys[] = {
    {"ns", &MtlMaterial::ns, no_limit},
    {"ni", &MtlMaterial::ni, index_range.greatest},
    {"d", &MtlMaterial::dissolve, 1},
    {"tr", &MtlMaterial::transparency, 1},
    {"pr", &MtlMaterial::roughness, 1},
    {"pm", &MtlMaterial::metallic, 1},
    {"ps", &MtlMaterial::sheen, 1},
    {"pc", &MtlMaterial::clearcoat, 1},
    {"pcr", &MtlMaterial::clearcoat_roughness, 1},
    {"aniso", &MtlMaterial::anisotropy, 1},
    {"anisor", &MtlMaterial::anisotropy_rotation, 1},
};

struct MapKey {
  std::string_view key;
  MtlMap map;
};
constexpr MapKey map_keys[] = {
    {"map_kd", MtlMap::kd},
    {"map_ks", MtlMap::ks},
    {"map_ke", MtlMap::ke},
    {"map_ns", MtlMap::ns},
    {"map_pr", MtlMap::roughness},
    {"map_pm", MtlMap::metallic},
    {"map_ps", MtlMap::sheen},
    {"map_pc", MtlMap::clearcoat},
    {"map_pcr", MtlMap::clearcoat_roughness},
    {"map_d", MtlMap::dissolve},
    {"map_opacity", MtlMap::dissolve},
    {"norm", MtlMap::normal},
    {"map_kn", MtlMap::normal},
    {"map_bump", MtlMap::bump},
    {"bump", MtlMap::bump},
    {"map_aniso", MtlMap::anisotropy},
    {"map_anisor", MtlMap::anisotropy_rotation},
};

/// Images that would change the picture, but are not done.
constexpr std::string_view maps_not_done[] = {"disp", "map_disp", "decal"};

class MtlReader {
 public:
  MtlReader(std::string_view text, const std::filesystem::path& file, WarningList& warnings)
      : warnings_(warnings), lines_(text, file.string()) {
    mtl_.path = file;
    const std::string_view first = trimmed(without_bom(text).substr(0, text.find_first_of("\r\n")));
    mtl_.from_blender = first.starts_with('#') && first.find("Blender") != first.npos;
  }

  MtlFile read() {
    while (lines_.next_line()) read_statement();
    return std::move(mtl_);
  }

 private:
  void warn(const std::string& message, Harm harm = Harm::changes_picture) {
    warnings_.add(lines_.place(), message, harm);
  }

  /// Keys count in letters of either case: some exporters write "map_kd" or "ni".
  void read_statement() {
    const std::string key(lines_.word());
    const std::string name = lower_case(key);
    if (name == "newmtl") return begin_material();
    if (mtl_.materials.empty())
      return warn(fmt::format("'{}' in front of the first newmtl is left out", printable(key)));
    MtlMaterial& material = mtl_.materials.back();
    if (name == "illum") return read_illum(material);
    if (const auto k = std::ranges::find(color_keys, name, &ColorKey::key); k != std::end(color_keys))
      return read_color(key, material.*(k->color), k->greatest);
    if (const auto k = std::ranges::find(number_keys, name, &NumberKey::key); k != std::end(number_keys))
      return read_number(key, material.*(k->number), k->greatest);
    if (const auto k = std::ranges::find(map_keys, name, &MapKey::key); k != std::end(map_keys))
      return read_map(key, material.map(k->map));
    if (std::ranges::find(maps_not_done, name) != std::end(maps_not_done)) return warn(key + " is not done");
    if (std::ranges::find(mtl_.ignored, key) == mtl_.ignored.end() && mtl_.ignored.size() < most_ignored)
      mtl_.ignored.push_back(key);
  }

  void begin_material() {
    const std::string name(lines_.rest());
    if (name.empty()) warn("newmtl without a name", Harm::none);
    if (!names_.insert(name).second)
      warn("newmtl of a name that is there already: the first material of it counts");
    mtl_.materials.push_back({.name = name, .place = lines_.place()});
  }

  /// Takes a number into 0 .. greatest, with a warning where it is outside. What is too small to matter is 0.
  double in_range(const std::string& key, double value, double greatest) {
    if (!float_range.contains(value))
      lines_.fail(
          fmt::format("{} must be a number of at most {}, not {:g}", key, float_range.greatest, value));
    if (std::abs(value) < radiance_range.least_but_zero) return 0;
    if (value >= 0 && value <= greatest) return value;
    const double nearest = std::clamp(value, 0.0, greatest);
    warn(greatest == no_limit ? fmt::format("{} below 0: read as 0", key)
                              : fmt::format("{} outside 0 .. {}: clamped", key, greatest));
    return nearest;
  }

  /// One number stands for three.
  void read_color(const std::string& key, std::optional<Vec3d>& color, double greatest) {
    if (const std::string_view form = lines_.peek(); form == "spectral" || form == "xyz")
      return warn(fmt::format("{} {} is not read", key, form));
    const double red = in_range(key, lines_.required_number(key), greatest);
    color = Vec3d(red);
    const std::optional<double> green = lines_.number(key);
    if (!green) return;
    color->y = in_range(key, *green, greatest);
    color->z = in_range(key, lines_.required_number(key), greatest);
  }

  void read_number(const std::string& key, std::optional<double>& number, double greatest) {
    if (lines_.peek() == "-halo") {
      lines_.word();
      warn(fmt::format("{} -halo is read as {}", key, key));
    }
    number = in_range(key, lines_.required_number(key), greatest);
  }

  void read_illum(MtlMaterial& material) {
    const double model = lines_.required_number("illum");
    if (!(model >= 0 && model <= 10)) return warn("illum outside 0 .. 10 is left out");
    material.illum = static_cast<int>(model);
  }

  void read_map(const std::string& key, std::optional<TextureStatement>& map) {
    TextureStatement statement = read_texture_statement(key, lines_);
    if (statement.file.empty()) return warn(fmt::format("{} without a file name is left out", key));
    map = std::move(statement);
  }

  static constexpr std::size_t most_ignored = 100;

  WarningList& warnings_;
  LineReader lines_;
  std::unordered_set<std::string> names_;
  MtlFile mtl_;
};

}  // namespace

MtlFile parse_mtl(std::string_view text, const std::filesystem::path& file, WarningList& warnings) {
  return MtlReader(text, file, warnings).read();
}

MtlFile read_mtl(const std::filesystem::path& file, WarningList& warnings) {
  return parse_mtl(read_file(file), file, warnings);
}

}  // namespace castray
