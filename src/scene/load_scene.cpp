#include <optional>
#include <string>

#include "castray/error.h"
#include "castray/scene.h"
#include "core/files.h"
#include "scene/obj_mesh.h"
#include "scene/scene_file.h"

namespace castray {

namespace {

/// The name of a scene that is read from the standard input.
constexpr const char* nameless = "scene";

/// `text`: the content of a file that cannot be read by its name.
Scene load_obj(const std::filesystem::path& file, std::optional<std::string_view> text = {}) {
  SceneBuilder builder;
  builder.scene.file = file;
  builder.scene.name = file.stem().string();
  ObjMaterials materials(builder);
  builder.add(make_mesh(text ? parse_obj(*text, file, builder.warnings) : read_obj(file, builder.warnings),
                        {}, materials),
              file);
  Scene scene = builder.finish();
  scene.camera = automatic_camera(scene);
  return scene;
}

/// A scene file is an object, maybe behind comments.
bool is_json(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != text.npos && (text[first] == '{' || text[first] == '/');
}

Scene load_standard_input() {
  const std::string text = read_file("/dev/stdin");
  Scene scene = is_json(text) ? parse_scene(text, "-") : load_obj("-", text);
  scene.name = nameless;
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  const std::string suffix = suffix_of(file);
  if (file == "-") return load_standard_input();
  if (suffix == ".json") return read_scene_file(file);
  if (suffix == ".obj") return load_obj(file);
  std::error_code ignored;
  throw InputError(SourcePlace{file.string()}, std::filesystem::is_directory(file, ignored)
                                                   ? "is a folder; give a scene file in it, .json or .obj"
                                                   : "not a scene: its name must end in .json or .obj");
}

}  // namespace castray
