#include "fuzz.h"
#include "scene/mtl_file.h"

FUZZ(text) {
  castray::SceneBuilder builder;
  castray::parse_mtl(text, "nowhere/o.mtl", builder);
}
