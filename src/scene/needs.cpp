#include "scene/needs.h"

#include "materials/descriptor.h"

namespace castray {

SceneNeeds needs_of(const Scene& scene) {
  SceneNeeds needs;
  needs.triangles = scene.triangles.size();
  needs.instances = scene.instances.size();
  needs.lights = scene.lights.size();
  needs.smooth_normals = !scene.triangle_normals.empty();
  needs.delta_lights = scene.delta_lights.size();
  needs.environment = max_component(scene.environment) > 0;
  const std::vector<bool> used = scene.used_materials();
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const Material& m = scene.materials[i];
    needs.textures |= m.has_maps_of_values() && !scene.triangle_uvs.empty();
    needs.textures |= m.vertex_colors && !scene.triangle_colors.empty();
    needs.textures |= (traits_of(m) & trait_stretched) != 0;
    needs.specular |= (traits_of(m) & (trait_specular | trait_focuses)) != 0;
    needs.glossy |= (traits_of(m) & trait_directional) && (traits_of(m) & trait_shareable);
    needs.narrow_coats |= has_narrow_coat(m);
    needs.bent_normals |= (traits_of(m) & trait_bent) != 0;
    needs.coverage |= m.may_have_holes();
    needs.glass_shares |= m.has_glass();
    needs.types.insert(m.type);
  }
  return needs;
}

}  // namespace castray
