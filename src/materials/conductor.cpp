#include "materials/conductor.h"

namespace castray {

Vec3d mean_fresnel(const Material& m) {
  constexpr int steps = 200;
  Vec3d sum;
  for (int i = 0; i < steps; ++i) {
    const double c = std::sqrt((i + 0.5) / steps);  // even steps of 2 c dc
    for (int channel = 0; channel < 3; ++channel)
      sum[channel] += fresnel_conductor(c, m.eta[channel], m.k[channel]) / steps;
  }
  return sum;
}

const MaterialDescriptor& conductor_descriptor() {
  static const MaterialDescriptor descriptor{
      .type = MaterialType::conductor,
      .name = "conductor",
      .text = "A metal, by a constant reflectance or by its index of refraction: GGX facets, or a mirror.",
      .formula = "F D G2 / (4 cos_i cos_o), F by the `reflectance`; more with `multiple_scattering`",
      .keys = with_common_keys({{.name = "reflectance",
                                 .kind = MaterialKey::Kind::color,
                                 .field = &Material::reflectance,
                                 .range = unit_range,
                                 .parameter = SurfaceParameter::reflectance,
                                 .slot = slot_ks,
                                 .text = "At all angles, or a metal by name or by index [0.8, 0.8, 0.8].",
                                 .brief = true},
                                roughness_key(),
                                alpha_key(),
                                anisotropy_key(),
                                anisotropy_rotation_key(),
                                optional_in_hash(anisotropy_direction_key()),
                                multiple_scattering_key()}),
      .traits = [](const Material& m) -> std::uint32_t {
        return trait_directional | (has_smooth_lobe(m) ? trait_specular | trait_smooth : 0u) |
               (has_narrow_lobe(m) ? trait_focuses : 0u) | (has_stretched_lobe(m) ? trait_stretched : 0u);
      },
      .albedo = [](const SurfaceValues<double>& v) { return v.color(slot_ks); },
      .finish =
          [](const Material& m, const LobeAlbedo& lobe, double* values) {
            const Vec3d reflectance(values[slot_ks], values[slot_ks + 1], values[slot_ks + 2]);
            const Vec3d again = scattered_again(m.has_index() ? mean_fresnel(m) : reflectance, lobe);
            for (int c = 0; c < 3; ++c) values[slot_kd + c] = again[c];
          }};
  return descriptor;
}

}  // namespace castray
