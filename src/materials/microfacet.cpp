#include "materials/microfacet.h"

namespace castray {

const MaterialDescriptor& microfacet_descriptor() {
  using Kind = MaterialKey::Kind;
  static const MaterialDescriptor descriptor{
      .type = MaterialType::microfacet,
      .name = "microfacet",
      .text = "A GGX coat over a diffuse base.",
      .formula = "F D G2 / (4 cos_i cos_o) + kd / pi (1 - E(cos_i)) (1 - E(cos_o)) / (1 - E_mean)",
      .keys = with_common_keys({{.name = "kd",
                                 .kind = Kind::color,
                                 .field = &Material::kd,
                                 .range = unit_range,
                                 .parameter = SurfaceParameter::kd,
                                 .slot = slot_kd,
                                 .text = "Albedo of the base [0.5, 0.5, 0.5].",
                                 .brief = true},
                                vertex_colors_key(),
                                {.name = "ks",
                                 .kind = Kind::color,
                                 .field = &Material::ks,
                                 .range = unit_range,
                                 .parameter = SurfaceParameter::ks,
                                 .slot = slot_ks,
                                 .text = "The coat's reflectance straight on [0, 0, 0].",
                                 .brief = true},
                                roughness_key(),
                                alpha_key()}),
      .traits = [](const Material& m) -> std::uint32_t {
        return trait_directional | (has_smooth_lobe(m) ? trait_specular : 0u);
      },
      .albedo =
          [](const SurfaceValues<double>& v) { return coated_albedo(v.color(slot_kd), v.color(slot_ks)); },
      .finish =
          [](const Material&, const LobeAlbedo& lobe, double* values) {
            const auto vec = [&](int slot) {
              return Vec3d(values[slot], values[slot + 1], values[slot + 2]);
            };
            const Vec3d base = base_under(vec(slot_kd), vec(slot_ks), lobe);
            for (int c = 0; c < 3; ++c) values[slot_kd + c] = base[c];
          }};
  return descriptor;
}

}  // namespace castray
