#include <fmt/core.h>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "castray/error.h"
#include "castray/image.h"
#include "castray/scene_files.h"
#include "core/files.h"
#include "core/text.h"
#include "scene/gltf_scene.h"
#include "scene/gltf_texture.h"
#include "scene/material_writer.h"
#include "scene/names.h"
#include "scene/ply_file.h"
#include "scene/pretty_json.h"

namespace castray {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// A scene that is read, and what a scene file has to say of it besides.
struct Source {
  Scene scene;
  std::string mesh_key;                              ///< "gltf", "obj" or "ply"
  std::map<std::string, std::uint16_t> materials;    ///< by their names in the mesh's file
  Json cameras, lights;                              ///< as the file has them, by name; empty: it has none
  std::function<std::string(int)> embedded_image{};  ///< its encoded bytes
};

Source read_gltf_source(const GltfDocument& document, WarningList warnings) {
  const GltfNodes nodes = place_nodes(document);
  Source source{
      scene_of_gltf(document, nodes, std::move(warnings)), "gltf", {}, {}, {}, [&document](int image) {
        return std::string(embedded_image(document, static_cast<std::size_t>(image)));
      }};
  for (std::size_t m = 0; m < source.scene.materials.size(); ++m)
    if (!source.scene.materials[m].is_glass_share)  // which follows from another
      source.materials[source.scene.materials[m].name] = static_cast<std::uint16_t>(m);
  for (const std::string& name : camera_names(document, nodes))
    source.cameras[name] = camera_json(document, nodes.cameras[source.cameras.size()]);
  WarningList told;  // by scene_of_gltf
  for (const GltfPlaced& light : nodes.lights) source.lights.push_back(light_json(document, light, told));
  return source;
}

Source read_mesh_source(const fs::path& file, const std::string& key,
                        ObjFile (*read)(const fs::path&, WarningList&)) {
  SceneBuilder builder;
  builder.scene.file = file;
  ObjMaterials materials(builder);
  ObjFile mesh = read(file, builder.warnings);
  const std::vector<std::uint16_t> indices = materials.find_all(mesh, {});
  MeshOptions options;
  std::map<std::string, std::uint16_t> by_name;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    by_name[mesh.materials[i].name] = indices[i];
    options.materials.add(mesh.materials[i].name, indices[i], {});
  }
  builder.add(make_mesh(std::move(mesh), options, materials), file);
  return {builder.finish(), key, std::move(by_name), {}, {}};
}

/// The view that was found for a file without camera.
Json view_json(const Scene& scene) {
  constexpr double digits = 1e9;
  const Camera camera = scene.to_world(scene.camera);
  const auto list = [](const Vec3d& v) { return Json::array({v.x, v.y, v.z}); };
  const double fov = std::atan(camera.tan_half_fov) * 360 / std::numbers::pi;
  return {{"position", list(camera.position)},
          {"look_at", list(camera.position + camera.forward * scene.unit)},
          {"up", list(camera.up)},
          {"fov", std::round(fov * digits) / digits}};
}

std::string png_of(const Texture& texture) {
  if (texture.bytes.empty())
    throw InputError(
        "the image '" + printable(texture.name) +
        "' is mirrored, and has more than 8 bits a value: it cannot be written beside the scene file");
  std::string bytes;
  const auto append = [](void* to, void* from, int size) {
    static_cast<std::string*>(to)->append(static_cast<char*>(from), static_cast<std::size_t>(size));
  };
  stbi_write_png_to_func(append, &bytes, texture.width, texture.height, texture.channels,
                         texture.bytes.data(), texture.width * texture.channels);
  return bytes;
}

class SceneWriter {
 public:
  SceneWriter(const Source& source, const fs::path& input, const fs::path& output)
      : source_(source), input_(input), output_(output) {}

  SceneFiles write() {
    const Scene& scene = source_.scene;
    Json json;
    if (source_.cameras.size() > 1)
      json["cameras"] = source_.cameras;
    else
      json["camera"] = source_.cameras.empty() ? view_json(scene) : source_.cameras.front();
    json["image"] = {{"width", scene.width}, {"height", scene.height}};
    if (scene.default_environment) json["environment"] = {{"radiance", {1, 1, 1}}};
    if (!source_.lights.empty()) json["lights"] = source_.lights;
    const std::vector<std::string> names = material_names();
    for (std::size_t m = 0; m < names.size(); ++m)
      if (!scene.materials[m].is_glass_share)
        json["materials"][names[m]] =
            material_json(scene.materials[m], scene, [this](int texture) { return image_path(texture); });
    Json mesh = {{source_.mesh_key, relative(input_)}};
    if (source_.materials.size() == 1 && source_.materials.contains(""))
      mesh["material"] = names[source_.materials.at("")];
    else
      for (const auto& [name, material] : source_.materials) mesh["materials"][name] = names[material];
    json["meshes"] = Json::array({mesh});
    files_.scene = {output_, pretty_json(json) + "\n"};
    files_.warnings = scene.warnings;
    return std::move(files_);
  }

 private:
  std::vector<std::string> material_names() const {
    std::vector<std::string> names;
    for (const Material& material : source_.scene.materials) names.push_back(material.name);
    return without_repeats(std::move(names));
  }

  std::string relative(const fs::path& file) const {
    return fs::proximate(fs::absolute(file), fs::absolute(output_).parent_path()).generic_string();
  }

  /// The path of a texture's file, which is made where it has none.
  std::string image_path(int texture) {
    const Texture& t = source_.scene.textures[static_cast<std::size_t>(texture)];
    if (!t.source.file.empty() && t.source.image < 0) return relative(t.source.file);
    const std::string bytes = t.source.image < 0 ? png_of(t) : source_.embedded_image(t.source.image);
    const std::string stem =
        as_file_name(output_.stem().string() + "_" + fs::path(t.name).replace_extension().string());
    for (int n = 1;; ++n) {
      const fs::path name = (n == 1 ? stem : fmt::format("{}_{}", stem, n)) + suffix_of_image(bytes);
      const auto same =
          std::ranges::find(files_.images, output_.parent_path() / name, &SceneFiles::File::path);
      if (same == files_.images.end())
        files_.images.push_back({output_.parent_path() / name, bytes});
      else if (same->bytes != bytes)
        continue;
      return name.string();
    }
  }

  const Source& source_;
  const fs::path &input_, &output_;
  SceneFiles files_;
};

}  // namespace

SceneFiles convert_scene(const fs::path& input, const fs::path& output) {
  const std::string suffix = suffix_of(input);
  const auto write = [&](const Source& source) { return SceneWriter(source, input, output).write(); };
  if (suffix == ".obj") return write(read_mesh_source(input, "obj", read_obj));
  if (suffix == ".ply") return write(read_mesh_source(input, "ply", read_ply));
  WarningList warnings;
  const GltfDocument document = read_gltf(input, warnings);
  return write(read_gltf_source(document, std::move(warnings)));
}

}  // namespace castray
