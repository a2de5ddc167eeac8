#include "materials/diffuse.h"

namespace castray {

const MaterialDescriptor& diffuse_descriptor() {
  static const MaterialDescriptor descriptor{
      .type = MaterialType::diffuse,
      .name = "diffuse",
      .text = "Lambert's: the same radiance in every direction.",
      .formula = "kd / pi",
      .keys = with_common_keys({{.name = "kd",
                                 .kind = MaterialKey::Kind::color,
                                 .field = &Material::kd,
                                 .range = unit_range,
                                 .parameter = SurfaceParameter::kd,
                                 .slot = slot_kd,
                                 .text = "Albedo [0.5, 0.5, 0.5].",
                                 .brief = true},
                                vertex_colors_key()}),
      .traits = [](const Material&) -> std::uint32_t { return 0; },
      .albedo = [](const SurfaceValues<double>& v) { return v.color(slot_kd); }};
  return descriptor;
}

}  // namespace castray
