#include "scene/mtl_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/files.h"
#include "core/text.h"
#include "scene/line_reader.h"
#include "scene/texture_statement.h"

namespace castray {

namespace {

/// What an MTL file says of one material.
struct MtlMaterial {
  std::string name;
  std::optional<Vec3d> kd{};
  Vec3d ks{}, ke{};
  std::optional<double> ns{}, ni{}, roughness{}, metallic{};
  std::optional<int> illum{};
  TextureMap kd_map{};
};

/// The first that fits of conductor, dielectric, microfacet, diffuse.
Material to_material(const MtlMaterial& mtl) {
  const auto illum_is = [&](std::initializer_list<int> models) {
    return mtl.illum && std::ranges::find(models, *mtl.illum) != models.end();
  };
  const bool shines = max_component(mtl.ks) > 0;
  Material material;
  material.name = mtl.name;
  material.ke = mtl.ke;
  material.map(SurfaceParameter::kd) = mtl.kd_map;
  if (mtl.kd)
    material.kd = *mtl.kd;
  else if (mtl.kd_map.used())
    material.kd = Vec3d(1.0);
  if (mtl.roughness)
    material.alpha = *mtl.roughness * *mtl.roughness;
  else if (mtl.ns)
    material.alpha = std::min(1.0, std::sqrt(2 / (*mtl.ns + 2)));
  if (illum_is({3, 5}) || mtl.metallic == 1.0) {
    material.type = MaterialType::conductor;
    // A metal's colour is Kd in the Pm convention, Ks in the classic one.
    material.reflectance = mtl.metallic == 1.0 ? material.kd : shines ? mtl.ks : material.reflectance;
    if (!mtl.roughness && !mtl.ns) material.alpha = 0;
  } else if (illum_is({4, 6, 7, 9}) && mtl.ni && *mtl.ni > 1) {
    material.type = MaterialType::dielectric;
    material.ior = *mtl.ni;
    if (!mtl.roughness)
      material.alpha = 0;  // Ns of glass is the width of a highlight drawn on it, not of its surface
  } else if (shines && (mtl.ns || mtl.roughness)) {
    material.type = MaterialType::microfacet;
    material.ks = mtl.ks;
  }
  return material;
}

class MtlReader {
 public:
  MtlReader(std::string_view text, const std::filesystem::path& file, SceneBuilder& builder)
      : file_(file), builder_(builder), lines_(text, file.string()) {}

  std::vector<std::uint16_t> read() {
    while (lines_.next_line()) read_statement();
    std::vector<std::uint16_t> indices;
    for (const MtlMaterial& material : materials_)
      indices.push_back(builder_.add_material(to_material(material)));
    return indices;
  }

 private:
  // clang-format off
  void read_statement() {
    const std::string key(lines_.word());
    if (key == "newmtl") return begin_material();
    if (materials_.empty()) lines_.fail(fmt::format("'{}' in front of the first newmtl", printable(key)));
    MtlMaterial& material = materials_.back();
    if (key == "Kd") material.kd = color(key, 1);
    else if (key == "Ks") material.ks = color(key, 1);
    else if (key == "Ke") material.ke = color(key, no_limit);
    else if (key == "Ns") material.ns = number(key, no_limit);
    else if (key == "Ni") material.ni = number(key, no_limit);
    else if (key == "Pr") material.roughness = number(key, 1);
    else if (key == "Pm") material.metallic = number(key, 1);
    else if (key == "illum") material.illum = static_cast<int>(number(key, 10));
    else if (key == "map_Kd") read_texture(material);
    else builder_.ignore(file_, key);
  }
  // clang-format on

  static constexpr double no_limit = std::numeric_limits<double>::max();

  double check(const std::string& key, double value, double greatest) {
    if (value >= 0 && value <= greatest) return value;
    lines_.fail(greatest == no_limit ? fmt::format("{} must be finite and at least 0, not {}", key, value)
                                     : fmt::format("{} must be in 0 .. {}, not {}", key, greatest, value));
  }

  double number(const std::string& key, double greatest) {
    return check(key, lines_.required_number(key), greatest);
  }

  /// One number stands for three.
  Vec3d color(const std::string& key, double greatest) {
    const double red = number(key, greatest);
    const std::optional<double> green = lines_.number(key);
    if (!green) return Vec3d(red);
    check(key, *green, greatest);
    return {red, *green, number(key, greatest)};
  }

  void begin_material() {
    const std::string name(lines_.rest());
    if (name.empty()) lines_.fail("newmtl needs a name");
    if (materials_.size() > std::numeric_limits<std::uint16_t>::max())
      lines_.fail("too many materials; use fewer");
    materials_.push_back({.name = name});
  }

  void read_texture(MtlMaterial& material) {
    const TextureStatement texture = read_texture_statement(lines_);
    for (const std::string& option : texture.ignored_options) builder_.ignore(file_, "map_Kd " + option);
    const std::filesystem::path path = resolve_path(texture.file, file_);
    if (!is_file(path)) lines_.fail(fmt::format("map_Kd: no such file: {}", printable(path.string())));
    material.kd_map = texture.map;
    material.kd_map.texture = builder_.add_texture(path, ColorSpace::srgb);
  }

  std::filesystem::path file_;
  SceneBuilder& builder_;
  LineReader lines_;
  std::vector<MtlMaterial> materials_;
};

}  // namespace

std::vector<std::uint16_t> parse_mtl(std::string_view text, const std::filesystem::path& file,
                                     SceneBuilder& builder) {
  return MtlReader(text, file, builder).read();
}

std::vector<std::uint16_t> read_mtl(const std::filesystem::path& file, SceneBuilder& builder) {
  return parse_mtl(read_file(file), file, builder);
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_directory(status);
}

std::filesystem::path resolve_path(std::string_view name, const std::filesystem::path& named_in) {
  const std::filesystem::path folder = named_in.parent_path();
  if (std::filesystem::path as_written = folder / name; is_file(as_written)) return as_written;
  std::string slashes(name);
  std::ranges::replace(slashes, '\\', '/');
  return folder / slashes;
}

}  // namespace castray
