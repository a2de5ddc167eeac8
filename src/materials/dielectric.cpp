#include "materials/dielectric.h"

namespace castray {

namespace {

MaterialKey ior_key_told() {
  MaterialKey key = ior_key();
  key.brief = true;
  return key;
}

}  // namespace

const MaterialDescriptor& dielectric_descriptor() {
  static const MaterialDescriptor descriptor{
      .type = MaterialType::dielectric,
      .name = "dielectric",
      .text =
          "Glass: exact Fresnel reflection and refraction, smooth or through GGX facets; or a thin wall of "
          "it.",
      .formula =
          "reflection and refraction, smooth or through facets (Walter et al. 2007); `thin`: 2 F / (1 + F) "
          "is reflected, the rest goes straight on",
      .keys = with_common_keys({ior_key_told(),
                                {.name = "transmittance",
                                 .kind = MaterialKey::Kind::color,
                                 .field = &Material::transmittance,
                                 .range = unit_range,
                                 .parameter = SurfaceParameter::transmittance,
                                 .slot = slot_kd,
                                 .text = "Tint of what passes through the surface [1, 1, 1]."},
                                {.name = "thin",
                                 .kind = MaterialKey::Kind::flag,
                                 .field = &Material::thin,
                                 .text = "A smooth pane, of two surfaces and nothing inside: what passes "
                                         "is not bent [false]."},
                                absorption_key(),
                                roughness_key(),
                                alpha_key()}),
      .traits = [](const Material& m) -> std::uint32_t {
        const bool smooth = has_smooth_lobe(m) || m.ior == 1 || m.thin;
        return trait_directional | trait_transmits |
               (smooth ? trait_specular | trait_smooth : trait_focuses) | (m.is_window() ? trait_window : 0u);
      },
      .albedo = [](const SurfaceValues<double>&) { return Vec3d(1); }};
  return descriptor;
}

}  // namespace castray
