// OBJ text, into a finished scene.
#include "fuzz.h"
#include "scene/obj_file.h"

FUZZ(text) {
  castray::SceneBuilder builder;
  builder.add(castray::parse_obj(text, "nowhere/o.obj", {}, builder));
  builder.finish();
}
