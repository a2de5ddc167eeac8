#include "scene/scene_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/files.h"
#include "core/nearest.h"
#include "core/text.h"
#include "materials/descriptor.h"
#include "scene/camera_reader.h"
#include "scene/environment_reader.h"
#include "scene/json_reader.h"
#include "scene/lights_reader.h"
#include "scene/material_reader.h"
#include "scene/obj_mesh.h"
#include "scene/ply_file.h"
#include "scene/scene_builder.h"
#include "scene/transform.h"

namespace castray {

namespace {

const std::vector<std::string_view>& keys_of(std::string_view section) {
  for (const SceneSection& known : scene_sections())
    if (known.name == section) return known.keys;
  throw std::logic_error("no such section");
}

std::string flag_value(const JsonNode& node, std::string_view name) {
  switch (node.type) {
    case JsonNode::Type::number:
    case JsonNode::Type::string:
      return node.text;
    case JsonNode::Type::boolean:
      return node.number != 0 ? "on" : "off";
    case JsonNode::Type::array: {
      std::string joined;
      for (const JsonNode& child : node.children)
        joined += (joined.empty() ? "" : ",") + (read_number(child, name), child.text);
      return joined;
    }
    default:
      throw InputError(node.place, fmt::format("{} must be a flag's value, not {}", name, node.type_name()));
  }
}

class SceneFileReader {
 public:
  explicit SceneFileReader(const std::filesystem::path& file) : file_(file) {
    builder_.scene.file = file;
    builder_.scene.name = file.stem().string();
  }

  Scene read(std::string_view text) {
    const JsonNode root = parse_json(text, file_.string());
    const ObjectReader scene(root, "the scene", keys_of("scene"));
    if (const JsonNode* node = scene.find("image")) read_image_size(*node);
    if (const JsonNode* node = scene.find("render")) read_render(*node);
    if (const JsonNode* node = scene.find("environment")) read_environment(*node, file_, builder_);
    if (const JsonNode* node = scene.find("materials")) read_materials(*node);
    if (const JsonNode* lights = scene.find("lights"))
      for (const JsonNode& light : read_array(*lights, "\"lights\""))
        builder_.scene.delta_lights.push_back(read_delta_light(light));
    const JsonNode* camera = scene.find("camera");
    if (camera) builder_.scene.camera = read_camera(*camera);
    read_meshes(read_array(scene.require("meshes"), "\"meshes\""));
    Scene result = builder_.finish();
    result.has_camera = camera;
    if (camera)
      result.camera = result.to_scene(result.camera);
    else
      result.camera = automatic_camera(result);
    return result;
  }

 private:
  void read_image_size(const JsonNode& node) {
    const ObjectReader image(node, "\"image\"", keys_of("image"));
    Scene& scene = builder_.scene;
    if (const JsonNode* width = image.find("width"))
      scene.width = read_integer(*width, "\"width\"", 1, max_image_side);
    if (const JsonNode* height = image.find("height"))
      scene.height = read_integer(*height, "\"height\"", 1, max_image_side);
    if (static_cast<long long>(scene.width) * scene.height > max_image_pixels)
      throw InputError(node.place, fmt::format("{} x {} pixels are too many; at most {} in all", scene.width,
                                               scene.height, max_image_pixels));
  }

  void read_render(const JsonNode& node) {
    if (node.type != JsonNode::Type::object)
      throw InputError(node.place, fmt::format("\"render\" must be an object, not {}", node.type_name()));
    for (const JsonNode& flag : node.children)
      builder_.scene.render_defaults.push_back(
          {flag.key, flag_value(flag, "\"" + printable(flag.key) + "\""), flag.key_place});
  }

  void read_materials(const JsonNode& node) {
    if (node.type != JsonNode::Type::object)
      throw InputError(node.place, fmt::format("\"materials\" must be an object, not {}", node.type_name()));
    for (const JsonNode& member : node.children)
      material_indices_[member.key] = builder_.add_material(read_material(member, file_, builder_));
  }

  Transform read_step(const JsonNode& node) {
    const ObjectReader step(node, "a transform step", keys_of("transform_step"));
    if (node.children.size() != 1)
      throw InputError(node.place, "a transform step has one key: \"scale\", \"rotate\" or \"translate\"");
    if (const JsonNode* scale = step.find("scale")) {
      const bool uniform = scale->type == JsonNode::Type::number;
      const Vec3d factors =
          uniform ? Vec3d(read_number(*scale, "\"scale\"")) : read_vector(*scale, "\"scale\"");
      if (factors.x == 0 || factors.y == 0 || factors.z == 0)
        throw InputError(scale->place, "\"scale\" must not be 0: nothing would be left");
      return Transform::scale(factors);
    }
    if (const JsonNode* rotate = step.find("rotate")) {
      const std::vector<double> numbers = read_numbers(*rotate, "\"rotate\"", 4);
      const Vec3d axis{numbers[0], numbers[1], numbers[2]};
      if (axis == Vec3d{}) throw InputError(rotate->place, "\"rotate\" needs an axis that is not (0,0,0)");
      return Transform::rotate(axis, numbers[3]);
    }
    return Transform::translate(read_vector(step.require("translate"), "\"translate\""));
  }

  std::uint16_t find_material(const JsonNode& node) {
    const auto found = material_indices_.find(read_string(node, "\"material\""));
    if (found != material_indices_.end()) return found->second;
    std::vector<std::string_view> known;
    for (const auto& [name, index] : material_indices_) known.push_back(name);
    throw InputError(node.place, fmt::format("material '{}' not found{}", printable(node.text),
                                             known.empty() ? "; the scene has no \"materials\""
                                                           : suggestion(node.text, known)));
  }

  MeshOptions read_mesh_options(const ObjectReader& reader) {
    MeshOptions options;
    if (const JsonNode* material = reader.find("material")) options.material = find_material(*material);
    if (const JsonNode* normals = reader.find("normals"))
      options.normals = static_cast<NormalsFrom>(choose(*normals, "\"normals\"", {"file", "face", "smooth"}));
    if (const JsonNode* crease = reader.find("crease_angle")) {
      options.crease_angle = read_number(*crease, "\"crease_angle\"", {.least = 0, .greatest = 180});
      if (options.normals != NormalsFrom::smooth)
        throw InputError(crease->key_place, "\"crease_angle\" goes with \"normals\": \"smooth\" only");
    }
    return options;
  }

  /// Its mesh comes from an OBJ or a PLY file.
  std::filesystem::path mesh_path(const ObjectReader& mesh) const {
    const JsonNode* ply = mesh.find("ply");
    if (ply && mesh.find("obj")) throw InputError(ply->key_place, "give \"obj\" or \"ply\", not both");
    const JsonNode& node = ply ? *ply : mesh.require("obj");
    std::filesystem::path path = file_.parent_path() / read_string(node, ply ? "\"ply\"" : "\"obj\"");
    if (is_file(path)) return path;
    std::error_code ignored;
    throw InputError(
        node.place,
        fmt::format("{}: {}",
                    std::filesystem::is_directory(path, ignored) ? "a folder, not a file" : "no such file",
                    printable(path.string())));
  }

  void read_meshes(const std::vector<JsonNode>& nodes) {
    // A file is read once, and kept until its last use.
    std::map<std::filesystem::path, MeshUse> files;
    std::vector<MeshUse*> uses;
    for (const JsonNode& node : nodes) {
      const ObjectReader mesh(node, "a mesh", keys_of("mesh"));
      const std::filesystem::path path = mesh_path(mesh);
      uses.push_back(&files.try_emplace(path).first->second);
      uses.back()->path = path;
      uses.back()->read = mesh.find("ply") ? read_ply : read_obj;
      ++uses.back()->left;
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) read_mesh(nodes[i], *uses[i]);
  }

  struct MeshUse {
    std::filesystem::path path;
    ObjFile (*read)(const std::filesystem::path&, WarningList&) = nullptr;
    int left = 0;
    std::optional<ObjFile> file{};

    ObjFile take() {
      if (--left > 0) return *file;
      ObjFile last = std::move(*file);
      file.reset();
      return last;
    }
  };

  void read_mesh(const JsonNode& node, MeshUse& use) {
    const ObjectReader reader(node, "a mesh", keys_of("mesh"));
    const MeshOptions options = read_mesh_options(reader);
    Transform transform;
    if (const JsonNode* steps = reader.find("transform"))
      for (const JsonNode& step : read_array(*steps, "\"transform\""))
        transform = transform.then(read_step(step));
    if (!use.file) use.file = use.read(use.path, builder_.warnings);
    Mesh mesh = make_mesh(use.take(), options, materials_);
    if (reader.find("transform")) apply(transform, mesh);
    builder_.add(std::move(mesh), use.path);
  }

  std::filesystem::path file_;
  SceneBuilder builder_;
  ObjMaterials materials_{builder_};
  std::map<std::string, std::uint16_t> material_indices_;
};

}  // namespace

const std::vector<SceneSection>& scene_sections() {
  static const std::vector<SceneSection> sections = [] {
    std::vector<SceneSection> all = {
        {"scene", {"$schema", "camera", "image", "render", "materials", "meshes", "lights", "environment"}},
        {"camera", camera_keys},
        {"light", light_keys},
        {"lens", lens_keys},
        {"image", {"width", "height"}},
        {"environment", environment_keys},
        {"sky", sky_keys},
        {"gradient", gradient_keys},
        {"map", map_keys()},
        {"mesh", {"obj", "ply", "material", "transform", "normals", "crease_angle"}},
        {"transform_step", {"scale", "rotate", "translate"}},
    };
    for (const MaterialDescriptor* material : material_descriptors()) {
      all.push_back({material->name, {"type"}});
      for (const MaterialKey& key : material->keys) all.back().keys.push_back(key.name);
    }
    return all;
  }();
  return sections;
}

Scene parse_scene(std::string_view text, const std::filesystem::path& file) {
  return SceneFileReader(file).read(text);
}

Scene read_scene_file(const std::filesystem::path& file) { return parse_scene(read_file(file), file); }

}  // namespace castray
