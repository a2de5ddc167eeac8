// OBJ text, into a finished scene.
#include "fuzz.h"
#include "scene/obj_mesh.h"

FUZZ(text) {
  castray::SceneBuilder builder;
  castray::ObjMaterials materials(builder);
  const std::filesystem::path file = "nowhere/o.obj";
  builder.add(make_mesh(castray::parse_obj(text, file, builder.warnings), {}, materials), file);
  builder.finish();
}
