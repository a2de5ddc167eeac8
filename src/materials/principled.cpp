#include "materials/principled.h"

namespace castray {

const MaterialDescriptor& principled_descriptor() {
  using Kind = MaterialKey::Kind;
  static const MaterialDescriptor descriptor{
      .type = MaterialType::principled,
      .name = "principled",
      .text = "A blend of metal and coated base, under sheen and a clear coat.",
      .formula = "c f_c + C(cos_i) C(cos_o) (s (1 - wi.h)^5 + S(cos_i) S(cos_o) f_b)",
      .keys = with_common_keys(
          {{.name = "kd",
            .kind = Kind::color,
            .field = &Material::kd,
            .range = unit_range,
            .parameter = SurfaceParameter::kd,
            .slot = slot_kd,
            .text = "Albedo of the base, and the metal's reflectance straight on [0.5, 0.5, 0.5].",
            .brief = true},
           vertex_colors_key(),
           {.name = "ks",
            .kind = Kind::color,
            .field = &Material::ks,
            .range = unit_range,
            .parameter = SurfaceParameter::ks,
            .slot = slot_ks,
            .text = "Reflectance straight on of what is no metal [0, 0, 0].",
            .brief = true},
           {.name = "metallic",
            .kind = Kind::number,
            .field = &Material::metallic,
            .range = unit_range,
            .parameter = SurfaceParameter::metallic,
            .slot = slot_metallic,
            .text = "The metal's share [0].",
            .brief = true},
           {.name = "transmission",
            .kind = Kind::number,
            .field = &Material::transmission,
            .range = unit_range,
            .text = "The share of what is no metal that is glass, tinted by kd [0]."},
           ior_key(),
           absorption_key(),
           roughness_key(),
           alpha_key(),
           optional_in_hash(anisotropy_key()),
           optional_in_hash(anisotropy_rotation_key()),
           optional_in_hash(anisotropy_direction_key()),
           multiple_scattering_key(),
           {.name = "sheen",
            .kind = Kind::number,
            .field = &Material::sheen,
            .range = unit_range,
            .parameter = SurfaceParameter::sheen,
            .slot = slot_sheen,
            .text = "Of cloth, at grazing angles, on what is no metal [0]."},
           {.name = "clearcoat",
            .kind = Kind::number,
            .field = &Material::clearcoat,
            .range = unit_range,
            .parameter = SurfaceParameter::clearcoat,
            .slot = slot_clearcoat,
            .text = "The share of the surface that a coat covers [0]."},
           {.name = "clearcoat_roughness",
            .kind = Kind::number,
            .field = &Material::clearcoat_roughness,
            .range = unit_range,
            .parameter = SurfaceParameter::clearcoat_roughness,
            .slot = slot_clearcoat_roughness,
            .text = "Of the coat; its alpha is the square, at least 0.001 [0]."},
           optional_in_hash({.name = "clearcoat_ior",
                             .kind = Kind::number,
                             .field = &Material::clearcoat_ior,
                             .range = {.least = 1, .greatest = 3},
                             .text = "Index of refraction of the coat [1.5]."})}),
      .traits = [](const Material& m) -> std::uint32_t {
        const bool bare_metal = m.is_bare_metal() && m.clearcoat == 0;
        return trait_directional | (has_smooth_lobe(m) ? trait_specular : 0u) |
               (bare_metal && has_narrow_lobe(m) ? trait_focuses : 0u) |
               (m.multiple_scattering ? trait_scatters_again : 0u) |
               (has_stretched_lobe(m) ? trait_stretched : 0u);
      },
      .albedo =
          [](const SurfaceValues<double>& v) {
            const Vec3d kd = v.color(slot_kd), ks = v.color(slot_ks);
            const double metallic = v.at(slot_metallic);
            return coated_albedo(kd * (1 - metallic), ks + (kd - ks) * metallic);
          },
      .finish = [](const Material&, const LobeAlbedo&, double*) {}};
  return descriptor;
}

}  // namespace castray
