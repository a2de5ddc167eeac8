#include "materials/conductor.h"

namespace castray {

const MaterialDescriptor& conductor_descriptor() {
  static const MaterialDescriptor descriptor{
      .type = MaterialType::conductor,
      .name = "conductor",
      .text = "A metal of constant Fresnel reflectance: GGX facets, or a mirror.",
      .formula = "R D G2 / (4 cos_i cos_o), R the `reflectance`",
      .keys = with_common_keys({{.name = "reflectance",
                                 .kind = MaterialKey::Kind::color,
                                 .field = &Material::reflectance,
                                 .range = unit_range,
                                 .parameter = SurfaceParameter::reflectance,
                                 .slot = slot_ks,
                                 .text = "[0.8, 0.8, 0.8]",
                                 .brief = true},
                                roughness_key(),
                                alpha_key()}),
      .traits = [](const Material& m) -> std::uint32_t {
        return trait_directional | (has_smooth_lobe(m) ? trait_specular : 0u) |
               (has_narrow_lobe(m) ? trait_focuses : 0u);
      },
      .albedo = [](const SurfaceValues<double>& v) { return v.color(slot_ks); }};
  return descriptor;
}

}  // namespace castray
