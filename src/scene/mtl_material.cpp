#include "scene/mtl_material.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "materials/descriptor.h"
#include "scene/mtl_texture.h"

namespace castray {

namespace {

using enum SurfaceParameter;

/// A file's material as one of the renderer's.
class Meaning {
 public:
  Meaning(const MtlFile& file, const MtlMaterial& mtl, bool vertex_colors, SceneBuilder& builder)
      : mtl_(mtl),
        builder_(builder),
        dissolve_(dissolve()),
        blender_(file.from_blender || only_blender_writes()) {
    material_.name = mtl.name;
    read_base_color(vertex_colors);
    read_emission();
    read_coverage();
    read_normals();
    read_reflection();
  }

  std::uint16_t add() { return builder_.add_material(std::move(material_)); }

 private:
  bool illum_is(std::initializer_list<int> models) const {
    return mtl_.illum && std::ranges::find(models, *mtl_.illum) != models.end();
  }

  double dissolve() const {
    if (mtl_.dissolve) return *mtl_.dissolve;
    return mtl_.transparency ? 1 - *mtl_.transparency : 1;
  }

  bool is_partial() const { return (dissolve_ > 0 && dissolve_ < 1) || mtl_.map(MtlMap::dissolve); }

  /// illum 9, "glass", of what is half there.
  bool only_blender_writes() const { return illum_is({9}) && is_partial() && mtl_.ks && mtl_.ns; }

  bool is_glass() const {
    if (metal() > 0) return false;
    constexpr double mostly = 0.5;
    if (blender_ && mtl_.tf && max_component(*mtl_.tf) >= mostly) return true;
    return illum_is({4, 6, 7, 9}) && mtl_.ni && *mtl_.ni > 1 && !is_partial();
  }

  bool is_mapped(MtlMap map) const { return mtl_.map(map).has_value(); }

  /// Adds a map's image; false where there is none.
  bool set_map(SurfaceParameter parameter, MtlMap map, ColorSpace space,
               TextureMeaning meaning = TextureMeaning::amounts) {
    if (!is_mapped(map)) return false;
    return set_map(parameter, read_map(*mtl_.map(map), space, meaning, builder_));
  }

  bool set_map(SurfaceParameter parameter, const TextureMap& map) {
    material_.map(parameter) = map.used() ? map : TextureMap();
    return map.used();
  }

  /// A map alone, or beside black, which would hide it, is not scaled.
  static Vec3d color(const std::optional<Vec3d>& given, bool mapped, const Vec3d& otherwise) {
    if (mapped && (!given || max_component(*given) == 0)) return Vec3d(1.0);
    return given.value_or(otherwise);
  }

  void read_base_color(bool vertex_colors) {
    const bool mapped = set_map(kd, MtlMap::kd, ColorSpace::srgb);
    // What Blender writes beside map_Kd is the colour that the image stands in place of.
    material_.kd = mapped && blender_ ? Vec3d(1.0) : color(mtl_.kd, mapped, Vec3d(0.5));
    if (!vertex_colors || mtl_.kd || mapped) return;
    material_.kd = Vec3d(1.0);
    material_.vertex_colors = true;
  }

  void read_emission() {
    const bool mapped = set_map(ke, MtlMap::ke, ColorSpace::srgb);
    material_.ke = color(mtl_.ke, mapped, Vec3d(0.0));
  }

  void read_coverage() {
    if (is_glass()) return;
    material_.coverage = dissolve_;
    TextureMap& map = material_.map(coverage);
    if (set_map(coverage, MtlMap::dissolve, ColorSpace::linear)) {
      if (material_.coverage == 0) material_.coverage = 1;
      if (map.channel == Channel::color)
        map.channel = has_holes(texture_of(map)) ? Channel::alpha : Channel::luminance;
    } else if (material_.map(kd).used() && has_holes(texture_of(material_.map(kd)))) {
      map = material_.map(kd);
      map.channel = Channel::alpha;
    }
  }

  void read_normals() {
    if (set_normal_map(MtlMap::normal) ||
        !set_map(bump, MtlMap::bump, ColorSpace::linear, TextureMeaning::heights))
      return;
    TextureMap& heights = material_.map(bump);
    if (holds_normals(texture_of(heights))) {
      heights = {};
      set_normal_map(MtlMap::bump);
    } else {
      heights.gain *= static_cast<float>(mtl_.map(MtlMap::bump)->bump);
    }
  }

  bool set_normal_map(MtlMap map) {
    if (!set_map(normal, map, ColorSpace::linear, TextureMeaning::normals)) return false;
    material_.map(normal).gain = static_cast<float>(mtl_.map(map)->bump);
    return true;
  }

  const Texture& texture_of(const TextureMap& map) const {
    return builder_.scene.textures[static_cast<std::size_t>(map.texture)];
  }

  double metal() const { return mtl_.metallic.value_or(is_mapped(MtlMap::metallic) ? 1 : 0); }

  void read_roughness() {
    if (set_map(roughness, MtlMap::roughness, ColorSpace::linear)) {
      const double factor = blender_ ? 1 : mtl_.roughness.value_or(1);
      material_.alpha = factor > 0 ? factor * factor : 1;
    } else if (!mtl_.roughness && set_exponent_map()) {
      material_.alpha = 1;
    } else {
      material_.alpha = constant_alpha();
    }
  }

  /// Blender's map_Ns is of roughness itself; others' of a factor of the exponent, which is at most 1000.
  bool set_exponent_map() {
    if (blender_) return set_map(roughness, MtlMap::ns, ColorSpace::linear);
    if (!is_mapped(MtlMap::ns)) return false;
    constexpr double greatest = 1000;
    return set_map(roughness, read_exponent_map(*mtl_.map(MtlMap::ns), mtl_.ns.value_or(greatest), builder_));
  }

  double constant_alpha() const {
    if (mtl_.roughness) return *mtl_.roughness * *mtl_.roughness;
    if (!mtl_.ns) return illum_is({3, 5}) ? 0 : 1;
    // Blender: Ns = 1000 (1 - roughness)^2.
    if (blender_) return std::pow(1 - std::sqrt(std::min(1.0, *mtl_.ns / 1000)), 2);
    if (illum_is({3, 5}) && *mtl_.ns >= 1000) return 0;
    return alpha_of_exponent(*mtl_.ns);
  }

  /// Whether the material is told by metalness, as Blender and others do in MTL's extension for PBR.
  bool is_principled() const {
    return blender_ || mtl_.metallic || is_mapped(MtlMap::metallic) || has_layers();
  }

  /// Sheen or a clear coat.
  bool has_layers() const {
    return mtl_.sheen.value_or(0) > 0 || mtl_.clearcoat.value_or(0) > 0 || is_mapped(MtlMap::sheen) ||
           is_mapped(MtlMap::clearcoat);
  }

  /// What the layer over the base reflects straight on.
  Vec3d specular(bool mapped) const {
    constexpr double blender_scale = 0.08, usual_dielectric = 0.04;
    if (is_principled())
      return mtl_.ks || mapped ? color(mtl_.ks, mapped, {}) * blender_scale : Vec3d(usual_dielectric);
    if (illum_is({3, 5})) return color(mtl_.ks, mapped, Vec3d(0.8));
    const bool has_highlight = !illum_is({0, 1}) && (mtl_.ns || mtl_.roughness ||
                                                     is_mapped(MtlMap::roughness) || is_mapped(MtlMap::ns));
    return has_highlight ? color(mtl_.ks, mapped, Vec3d(0.0)) : Vec3d(0.0);
  }

  void read_reflection() {
    read_roughness();
    if (is_glass()) return read_glass();
    const Vec3d layer = specular(set_map(ks, MtlMap::ks, ColorSpace::srgb));
    const bool has_base = mtl_.kd || is_mapped(MtlMap::kd) || material_.vertex_colors;
    const bool mirror_only =
        illum_is({3, 5}) && !is_principled() && !(has_base && max_component(material_.kd) > 0);
    if (mirror_only && max_component(layer) > 0) {
      set_conductor(layer, ks);
    } else if (metal() == 1 && !is_mapped(MtlMap::metallic) && !has_layers()) {
      set_conductor(material_.kd, kd);
    } else if (metal() > 0 || has_layers()) {
      set_principled(layer);
    } else if (max_component(layer) > 0) {
      material_.type = MaterialType::microfacet;
      material_.ks = layer;
    } else {
      material_.map(ks) = {};
    }
    read_anisotropy();
  }

  /// Disney's (Burley 2012): the ratio of the lobe's widths is 1 - 0.9 aniso, and anisor a share of a turn.
  void read_anisotropy() {
    const double strength = mtl_.anisotropy.value_or(0);
    if (strength == 0 && !is_mapped(MtlMap::anisotropy)) return;
    const bool has_key =
        material_.type == MaterialType::conductor || material_.type == MaterialType::principled;
    if (!has_key || anisotropy_conflict(material_) != AnisotropyConflict::none)
      return builder_.warnings.add(
          mtl_.place,
          "aniso is done for metals, and for what has Pm, Ps or Pc and neither Ke nor "
          "an image of its roughness",
          Harm::changes_picture);
    material_.anisotropy = 0.9 * amount(mtl_.anisotropy, anisotropy, MtlMap::anisotropy);
    material_.anisotropy_rotation =
        360 * amount(mtl_.anisotropy_rotation, anisotropy_rotation, MtlMap::anisotropy_rotation);
  }

  void set_conductor(const Vec3d& color, SurfaceParameter source) {
    material_.type = MaterialType::conductor;
    material_.reflectance = color;
    material_.map(reflectance) = material_.map(source);
  }

  void set_principled(const Vec3d& layer) {
    material_.type = MaterialType::principled;
    material_.ks = layer;
    material_.metallic = amount(mtl_.metallic, metallic, MtlMap::metallic);
    material_.sheen = amount(mtl_.sheen, sheen, MtlMap::sheen);
    material_.clearcoat = amount(mtl_.clearcoat, clearcoat, MtlMap::clearcoat);
    material_.clearcoat_roughness =
        amount(mtl_.clearcoat_roughness, clearcoat_roughness, MtlMap::clearcoat_roughness);
  }

  /// A number and its image; a number of 0, which would hide the image, counts as 1.
  double amount(const std::optional<double>& given, SurfaceParameter parameter, MtlMap map) {
    const double number = given.value_or(0);
    return set_map(parameter, map, ColorSpace::linear) && number == 0 ? 1 : number;
  }

  void read_glass() {
    material_.type = MaterialType::dielectric;
    material_.ior = mtl_.ni && *mtl_.ni > 1 ? *mtl_.ni : 1.5;
    // Ns of glass is the width of a highlight drawn on it, not of its surface.
    if (!blender_ && !mtl_.roughness && !is_mapped(MtlMap::roughness)) {
      material_.alpha = 0;
      material_.map(roughness) = {};
    }
    if (blender_ && mtl_.tf)
      material_.transmittance = material_.kd;
    else
      material_.transmittance = mtl_.tf && max_component(*mtl_.tf) > 0 ? *mtl_.tf : Vec3d(1.0);
    if (blender_ && mtl_.tf) material_.map(transmittance) = material_.map(kd);
  }

  const MtlMaterial& mtl_;
  SceneBuilder& builder_;
  double dissolve_;
  bool blender_;
  Material material_{};
};

}  // namespace

std::uint16_t add_material(const MtlFile& file, const MtlMaterial& mtl, bool vertex_colors,
                           SceneBuilder& builder) {
  return Meaning(file, mtl, vertex_colors, builder).add();
}

}  // namespace castray
