// PLY, into a finished scene.
#include "fuzz.h"
#include "scene/obj_mesh.h"
#include "scene/ply_file.h"

FUZZ(bytes) {
  castray::SceneBuilder builder;
  castray::ObjMaterials materials(builder);
  const std::filesystem::path file = "nowhere/o.ply";
  builder.add(make_mesh(castray::parse_ply(bytes, file, builder.warnings), {}, materials), file);
  builder.finish();
}
