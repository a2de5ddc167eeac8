#include "lights/delta_lights.h"

#include "core/put.h"

namespace castray {

std::vector<KernelDelta> kernel_deltas(const std::vector<DeltaLight>& lights) {
  using Kind = DeltaLight::Kind;
  std::vector<KernelDelta> kernel;
  for (const DeltaLight& light : lights) {
    KernelDelta& k = kernel.emplace_back();
    put(k.at, light.kind == Kind::directional ? -light.direction : light.position);
    put(k.intensity, light.intensity);
    put(k.axis, light.direction);
    k.cos_outer = light.kind == Kind::spot ? static_cast<float>(light.cos_outer) : -3.f;
    k.inverse_width =
        light.kind == Kind::spot ? static_cast<float>(1 / (light.cos_inner - light.cos_outer)) : 1.f;
    k.infinite = light.kind == Kind::directional;
  }
  return kernel;
}

DeltaLight Scene::to_world(const DeltaLight& light) const {
  DeltaLight moved = light;
  moved.position = to_world(light.position);
  if (light.kind != DeltaLight::Kind::directional) moved.intensity = light.intensity * (unit * unit);
  return moved;
}

DeltaLight Scene::to_scene(const DeltaLight& light) const {
  DeltaLight moved = light;
  moved.position = to_scene(light.position);
  if (light.kind != DeltaLight::Kind::directional) moved.intensity = light.intensity / (unit * unit);
  return moved;
}

}  // namespace castray
