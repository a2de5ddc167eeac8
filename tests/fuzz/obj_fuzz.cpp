// OBJ text, into a finished scene.
#include "fuzz.h"
#include "scene/obj_mesh.h"

FUZZ(text) {
  castray::SceneBuilder builder;
  castray::ObjMaterials materials(builder);
  builder.add(make_mesh(castray::parse_obj(text, "nowhere/o.obj", builder.warnings), {}, materials));
  builder.finish();
}
