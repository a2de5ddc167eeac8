#include "fuzz.h"
#include "scene/mtl_material.h"

FUZZ(text) {
  castray::SceneBuilder builder;
  const castray::MtlFile file = castray::parse_mtl(text, "nowhere/o.mtl", builder.warnings);
  for (const castray::MtlMaterial& material : file.materials)
    castray::add_material(file, material, false, builder);
}
