#include "materials/descriptor.h"

#include <algorithm>
#include <cmath>

#include "materials/ggx.h"
#include "materials/lobe_albedo.h"
#include "materials/material_list.h"
#include "materials/surface_values.h"

namespace castray {

namespace {

template <class... Models>
std::vector<const MaterialDescriptor*> descriptors_of(const std::variant<Models...>*) {
  return {&Models::descriptor()...};
}

double aspect_of(double anisotropy) { return std::sqrt(1 - std::min(anisotropy, double{most_anisotropy})); }

}  // namespace

const std::vector<const MaterialDescriptor*>& material_descriptors() {
  static const auto all = [] {
    auto list = descriptors_of(static_cast<const AnyBsdf<double>*>(nullptr));
    std::ranges::sort(list, {}, &MaterialDescriptor::type);
    return list;
  }();
  return all;
}

const MaterialDescriptor& descriptor_of(MaterialType type) {
  return *material_descriptors()[static_cast<std::size_t>(type)];
}

std::vector<MaterialKey> with_common_keys(std::vector<MaterialKey> keys) {
  using Kind = MaterialKey::Kind;
  keys.insert(
      keys.end(),
      {{.name = "coverage",
        .kind = Kind::number,
        .field = &Material::coverage,
        .range = unit_range,
        .parameter = SurfaceParameter::coverage,
        .slot = slot_coverage,
        .text = "The share of the surface that is there [1]."},
       {.name = "ke",
        .kind = Kind::color,
        .field = &Material::ke,
        .range = radiance_range,
        .parameter = SurfaceParameter::ke,
        .slot = slot_emission,
        .text = "Emitted radiance, on the side that triangles turn counter-clockwise on [0, 0, 0]."},
       {.name = "two_sided_emission",
        .kind = Kind::flag,
        .field = &Material::two_sided_emission,
        .text = "Emit on both sides [false]."},
       {.name = "normal_map",
        .kind = Kind::image_only,
        .parameter = SurfaceParameter::normal,
        .text = "Shading normals in the frame of the texture coordinates; gain is their strength."},
       {.name = "bump_map",
        .kind = Kind::image_only,
        .parameter = SurfaceParameter::bump,
        .text =
            "Heights that bend shading normals; gain is the height of the value 1, in the scene's units."}});
  return keys;
}

MaterialKey optional_in_hash(MaterialKey key) {
  key.optional_in_hash = true;
  return key;
}

MaterialKey vertex_colors_key() {
  return {.name = "vertex_colors",
          .kind = MaterialKey::Kind::flag,
          .field = &Material::vertex_colors,
          .text = "The colours of the mesh's vertices multiply kd [false]."};
}

MaterialKey alpha_key() {
  return {.name = "alpha",
          .kind = MaterialKey::Kind::number,
          .field = &Material::alpha,
          .range = unit_range,
          .parameter = SurfaceParameter::alpha,
          .slot = slot_alpha,
          .text = "Width of the GGX distribution; 0 is smooth [0].",
          .brief = true};
}

MaterialKey roughness_key() {
  return {.name = "roughness",
          .kind = MaterialKey::Kind::squared,
          .field = &Material::alpha,
          .range = unit_range,
          .parameter = SurfaceParameter::roughness,
          .slot = slot_alpha,
          .text = "The square root of alpha."};
}

MaterialKey ior_key() {
  return {.name = "ior",
          .kind = MaterialKey::Kind::number,
          .field = &Material::ior,
          .range = index_range,
          .text = "Index of refraction inside over outside [1.5]."};
}

MaterialKey absorption_key() {
  return {.name = "absorption",
          .kind = MaterialKey::Kind::color,
          .field = &Material::absorption,
          .range = {.least = 0, .greatest = float_range.greatest},
          .text =
              "Inside, over a unit of length: e^-absorption is what light keeps; or the colour that is "
              "left after a distance [0, 0, 0]."};
}

MaterialKey anisotropy_key() {
  return {.name = "anisotropy",
          .kind = MaterialKey::Kind::number,
          .field = &Material::anisotropy,
          .range = {.least = 0, .greatest = 0.99},
          .parameter = SurfaceParameter::anisotropy,
          .slot = slot_anisotropy,
          .text = "1 - the ratio of the lobe's widths, whose geometric mean is alpha [0]."};
}

MaterialKey anisotropy_rotation_key() {
  return {.name = "anisotropy_rotation",
          .kind = MaterialKey::Kind::number,
          .field = &Material::anisotropy_rotation,
          .range = float_range,
          .parameter = SurfaceParameter::anisotropy_rotation,
          .text =
              "Degrees from the direction in which u grows, towards that of v, to the one in which the "
              "lobe is wide [0]."};
}

MaterialKey anisotropy_direction_key() {
  return {.name = "anisotropy_direction",
          .kind = MaterialKey::Kind::image_only,
          .parameter = SurfaceParameter::anisotropy_direction,
          .text =
              "The direction in which the lobe is wide, before it is turned, in the frame of the texture "
              "coordinates; of the normal map's form."};
}

MaterialKey multiple_scattering_key() {
  return {.name = "multiple_scattering",
          .kind = MaterialKey::Kind::flag,
          .field = &Material::multiple_scattering,
          .text = "Adds what facets reflect more than once, so that rough metals are not too dark [false]."};
}

bool has_smooth_lobe(const Material& m) { return Ggx<double>{m.alpha}.smooth() && !m.has_alpha_map(); }

bool has_stretched_lobe(const Material& m) {
  const bool has_key = m.type == MaterialType::conductor || m.type == MaterialType::principled;
  return has_key && m.anisotropy > 0 && !has_smooth_lobe(m);
}

AnisotropyConflict anisotropy_conflict(const Material& m) {
  if (m.type == MaterialType::conductor) return AnisotropyConflict::none;
  if (m.emits()) return AnisotropyConflict::emission;
  const bool several_widths_over_base = m.has_alpha_map() && !m.is_bare_metal();
  return several_widths_over_base ? AnisotropyConflict::roughness_image : AnisotropyConflict::none;
}

double lobe_aspect(const Material& m) { return has_stretched_lobe(m) ? aspect_of(m.anisotropy) : 1; }

double lobe_aspect(const Material& m, const SurfaceValues<double>& values) {
  const bool by_image = has_stretched_lobe(m) && m.map(SurfaceParameter::anisotropy).used();
  return by_image ? aspect_of(values.at(slot_anisotropy)) : lobe_aspect(m);
}

LobeWidths lobe_widths(const Material& m, double alpha) {
  // Bare metal has nothing below or above its lobe; and tables of round ones take a fifth of the time.
  if (m.type == MaterialType::principled && m.is_bare_metal() && m.clearcoat == 0) return {alpha};
  return {alpha, lobe_aspect(m), has_stretched_lobe(m) && m.map(SurfaceParameter::anisotropy).used()};
}

bool has_narrow_lobe(const Material& m) {
  constexpr double narrow_below = 0.1;  // where paths of one's own begin to be worth more than shared ones
  return !has_smooth_lobe(m) && !m.has_alpha_map() && m.alpha < narrow_below;
}

bool has_narrow_coat(const Material& m) {
  constexpr std::uint32_t mirrored = trait_specular | trait_transmits | trait_focuses;
  const std::uint32_t traits = traits_of(m);
  if (!(traits & trait_directional) || (traits & mirrored)) return false;
  return has_narrow_lobe(m) || m.clearcoat > 0;
}

bool uses_vertex_colors(const Material& m) {
  const auto is_key = [](const MaterialKey& key) { return key.field == vertex_colors_key().field; };
  return m.vertex_colors && std::ranges::any_of(descriptor_of(m.type).keys, is_key);
}

bool has_lobe_table(const Material& m) {
  if (m.type == MaterialType::conductor) return m.multiple_scattering && !has_smooth_lobe(m);
  return descriptor_of(m.type).finish;
}

bool has_lobe_rows(const Material& m) { return has_lobe_table(m) && m.has_alpha_map(); }

std::uint32_t traits_of(const Material& material) {
  std::uint32_t traits = descriptor_of(material.type).traits(material);
  if (!(traits & (trait_specular | trait_transmits))) traits |= trait_shareable;
  if (material.map(SurfaceParameter::normal).used() || material.map(SurfaceParameter::bump).used())
    traits |= trait_bent;
  if (material.emits())
    traits |= trait_emits | (material.two_sided_emission ? trait_emits_behind : 0u) |
              (material.emits_backwards ? trait_emits_backwards : 0u);
  return traits;
}

const std::vector<std::string_view>& channel_names() {
  static const std::vector<std::string_view> names{"color", "red", "green", "blue", "alpha", "luminance"};
  return names;
}

const std::vector<std::string_view>& filter_names() {
  static const std::vector<std::string_view> names{"none", "pixel"};
  return names;
}

bool takes_index(const MaterialKey& key, MaterialType type) {
  return type == MaterialType::principled ? key.parameter == SurfaceParameter::kd
                                          : key.parameter == SurfaceParameter::reflectance;
}

int floats_of(const MaterialKey& key) { return key.kind == MaterialKey::Kind::color ? 3 : 1; }

Vec3d value_of(const MaterialKey& key, const Material& material) {
  if (const auto* color = std::get_if<Vec3d Material::*>(&key.field)) return material.*(*color);
  if (const auto* number = std::get_if<double Material::*>(&key.field)) return Vec3d(material.*(*number));
  if (const auto* flag = std::get_if<bool Material::*>(&key.field)) return Vec3d(material.*(*flag) ? 1 : 0);
  return {};
}

}  // namespace castray
