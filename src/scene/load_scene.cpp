#include <algorithm>
#include <string>

#include "castray/error.h"
#include "castray/scene.h"
#include "scene/obj_file.h"
#include "scene/scene_builder.h"
#include "scene/scene_file.h"

namespace castray {

namespace {

Scene load_obj(const std::filesystem::path& file) {
  SceneBuilder builder;
  builder.scene.file = file;
  builder.scene.name = file.stem().string();
  builder.add(read_obj(file, {}, builder));
  Scene scene = builder.finish();
  scene.camera = automatic_camera(scene);
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  std::string suffix = file.extension().string();
  std::ranges::transform(suffix, suffix.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  Scene scene;
  if (suffix == ".json")
    scene = read_scene_file(file);
  else if (suffix == ".obj")
    scene = load_obj(file);
  else
    throw InputError(SourcePlace{file.string()}, "not a scene: its name must end in .json or .obj");
  if (scene.lights.empty() && max_component(scene.environment) == 0)
    scene.warnings.push_back("nothing in the scene emits light: the image will be black");
  return scene;
}

}  // namespace castray
