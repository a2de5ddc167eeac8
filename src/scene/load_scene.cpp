#include <string>

#include "castray/error.h"
#include "castray/scene.h"
#include "core/files.h"
#include "scene/obj_mesh.h"
#include "scene/scene_file.h"

namespace castray {

namespace {

Scene load_obj(const std::filesystem::path& file) {
  SceneBuilder builder;
  builder.scene.file = file;
  builder.scene.name = file.stem().string();
  ObjMaterials materials(builder);
  builder.add(make_mesh(read_obj(file, builder.warnings), {}, materials));
  Scene scene = builder.finish();
  scene.camera = automatic_camera(scene);
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  const std::string suffix = suffix_of(file);
  Scene scene;
  if (suffix == ".json")
    scene = read_scene_file(file);
  else if (suffix == ".obj")
    scene = load_obj(file);
  else
    throw InputError(SourcePlace{file.string()}, "not a scene: its name must end in .json or .obj");
  return scene;
}

}  // namespace castray
