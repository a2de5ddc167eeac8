#include <functional>
#include <string>

#include "castray/error.h"
#include "castray/scene.h"
#include "core/files.h"
#include "scene/gltf_scene.h"
#include "scene/obj_mesh.h"
#include "scene/ply_file.h"
#include "scene/scene_file.h"

namespace castray {

namespace {

/// The name of a scene that is read from the standard input.
constexpr const char* nameless = "scene";

/// A mesh alone.
Scene scene_of_mesh(const std::filesystem::path& file, const std::function<ObjFile(WarningList&)>& read) {
  SceneBuilder builder;
  builder.scene.file = file;
  builder.scene.name = file.stem().string();
  builder.is_asset = true;
  ObjMaterials materials(builder);
  builder.add(make_mesh(read(builder.warnings), {}, materials), file);
  return builder.finish();
}

Scene load_gltf(std::string_view bytes, const std::filesystem::path& file) {
  WarningList warnings;
  const GltfDocument document = parse_gltf(bytes, file, warnings);
  return scene_of_gltf(document, place_nodes(document), std::move(warnings));
}

/// A scene file is an object, maybe behind comments.
bool is_json(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != text.npos && (text[first] == '{' || text[first] == '/');
}

Scene parse_any(std::string_view text, const std::filesystem::path& file) {
  if (is_binary_gltf(text)) return load_gltf(text, file);
  if (is_json(text)) return parse_scene(text, file);
  const bool is_ply = text.starts_with("ply\n") || text.starts_with("ply\r");
  return scene_of_mesh(
      file, [&](WarningList& w) { return is_ply ? parse_ply(text, file, w) : parse_obj(text, file, w); });
}

Scene load_standard_input() {
  Scene scene = parse_any(read_file("/dev/stdin"), "-");
  scene.name = nameless;
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  const std::string suffix = suffix_of(file);
  if (file == "-") return load_standard_input();
  if (suffix == ".json") return read_scene_file(file);
  if (suffix == ".obj") return scene_of_mesh(file, [&](WarningList& w) { return read_obj(file, w); });
  if (suffix == ".gltf" || suffix == ".glb") return load_gltf(read_file(file), file);
  if (suffix == ".ply") return scene_of_mesh(file, [&](WarningList& w) { return read_ply(file, w); });
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) throw InputError(SourcePlace{file.string()}, "does not exist");
  throw InputError(SourcePlace{file.string()},
                   std::filesystem::is_directory(file, ignored)
                       ? "is a folder; give a scene file in it, .json, .gltf, .glb, .obj or .ply"
                       : "not a scene: its name must end in .json, .gltf, .glb, .obj or .ply");
}

}  // namespace castray
