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
#include "scene/gltf_scene.h"
#include "scene/json_reader.h"
#include "scene/lights_reader.h"
#include "scene/material_reader.h"
#include "scene/named_materials.h"
#include "scene/obj_mesh.h"
#include "scene/ply_file.h"
#include "scene/scene_builder.h"
#include "scene/transform_reader.h"

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

constexpr std::string_view material_name = "\"material\"";

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
    if (const JsonNode* node = scene.find("materials")) named_.read(*node);
    if (const JsonNode* lights = scene.find("lights"))
      for (const JsonNode& light : read_array(*lights, "\"lights\""))
        builder_.scene.delta_lights.push_back(read_delta_light(light));
    read_cameras(scene);
    read_geometry(scene);
    return builder_.finish();
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

  void read_cameras(const ObjectReader& scene) {
    const JsonNode *one = scene.find("camera"), *several = scene.find("cameras");
    if (one && several) throw InputError(several->key_place, "give \"camera\" or \"cameras\", not both");
    if (one) builder_.scene.cameras.push_back({"camera", read_camera(*one)});
    if (!several) return;
    if (several->type != JsonNode::Type::object || several->children.empty())
      throw InputError(several->place, "\"cameras\" must be an object of at least one camera");
    for (const JsonNode& member : several->children)
      builder_.scene.cameras.push_back({member.key, read_camera(member)});
  }

  void read_render(const JsonNode& node) {
    if (node.type != JsonNode::Type::object)
      throw InputError(node.place, fmt::format("\"render\" must be an object, not {}", node.type_name()));
    for (const JsonNode& flag : node.children)
      builder_.scene.render_defaults.push_back(
          {flag.key, flag_value(flag, "\"" + printable(flag.key) + "\""), flag.key_place});
  }

  /// By the names that the mesh's file has for materials.
  ReplacedMaterials read_replaced(const JsonNode& node) {
    if (node.type != JsonNode::Type::object)
      throw InputError(node.place,
                       fmt::format("\"materials\" of a mesh must be an object, not {}", node.type_name()));
    ReplacedMaterials replaced;
    for (const JsonNode& member : node.children)
      replaced.add(member.key, named_.find(member, material_name), member.key_place);
    return replaced;
  }

  MeshOptions read_mesh_options(const ObjectReader& reader) {
    MeshOptions options;
    if (const JsonNode* material = reader.find("material"))
      options.material = named_.find(*material, material_name);
    if (const JsonNode* replaced = reader.find("materials")) options.materials = read_replaced(*replaced);
    if (const JsonNode* normals = reader.find("normals"))
      options.normals = static_cast<NormalsFrom>(choose(*normals, "\"normals\"", {"file", "face", "smooth"}));
    if (const JsonNode* crease = reader.find("crease_angle")) {
      options.crease_angle = read_number(*crease, "\"crease_angle\"", {.least = 0, .greatest = 180});
      if (options.normals != NormalsFrom::smooth)
        throw InputError(crease->key_place, "\"crease_angle\" goes with \"normals\": \"smooth\" only");
    }
    return options;
  }

  /// The member that names the file of a mesh.
  static const JsonNode& file_of(const ObjectReader& mesh) {
    const JsonNode* found = nullptr;
    for (const char* key : {"obj", "ply", "gltf"}) {
      const JsonNode* node = mesh.find(key);
      if (node && found)
        throw InputError(node->key_place, fmt::format("give \"{}\" or \"{}\", not both", found->key, key));
      if (node) found = node;
    }
    return found ? *found : mesh.require("obj");
  }

  std::filesystem::path mesh_path(const ObjectReader& mesh) const {
    const JsonNode& node = file_of(mesh);
    return file_named_by(node, fmt::format("\"{}\"", node.key), file_);
  }

  /// Meshes and, where they are placed, objects.
  void read_geometry(const ObjectReader& scene) {
    const JsonNode* instances = scene.find("instances");
    if (const JsonNode* node = scene.find("instancing"))
      builder_.instancing =
          static_cast<Instancing>(choose(*node, "\"instancing\"", {"auto", "expand", "keep"}));
    if (const JsonNode* objects = scene.find("objects")) list_objects(*objects);
    if (instances)
      for (const JsonNode& node : read_array(*instances, "\"instances\"")) read_instance(node);
    if (const JsonNode* meshes = instances ? scene.find("meshes") : &scene.require("meshes"))
      list_meshes(*meshes, "\"meshes\"", {});
    for (const auto& [name, object] : objects_)
      if (object.index)
        list_meshes(*object.node, fmt::format("object '{}'", printable(name)), object.index);
      else
        builder_.warnings.add(object.node->key_place,
                              fmt::format("object '{}' has no instance", printable(name)), Harm::none);
    for (const MeshNode& mesh : meshes_) read_mesh(mesh);
  }

  void list_objects(const JsonNode& node) {
    if (node.type != JsonNode::Type::object)
      throw InputError(node.place, fmt::format("\"objects\" must be an object, not {}", node.type_name()));
    for (const JsonNode& member : node.children) objects_[member.key] = {&member, {}};
  }

  void read_instance(const JsonNode& node) {
    const ObjectReader reader(node, "an instance", keys_of("instance"));
    const JsonNode& name = reader.require("object");
    const auto found = objects_.find(read_string(name, "\"object\""));
    if (found == objects_.end())
      throw InputError(name.place, not_found("object", name.text, names_in(objects_)));
    if (!found->second.index) found->second.index = builder_.add_object();
    const JsonNode *each = reader.find("transforms"), *steps = reader.find("transform");
    const Transform all = steps ? read_transform(*steps) : Transform{};
    const std::vector<Transform> places = each ? read_transforms(*each, file_) : std::vector<Transform>(1);
    std::optional<std::uint16_t> material;
    if (const JsonNode* other = reader.find("material")) material = named_.find(*other, material_name);
    for (const Transform& place : places) builder_.place(*found->second.index, place.then(all), material);
  }

  /// Lists the meshes of the scene itself or of an object. A file is read once, and kept until its last use.
  void list_meshes(const JsonNode& nodes, std::string_view name, std::optional<std::size_t> object) {
    for (const JsonNode& node : read_array(nodes, name)) {
      const ObjectReader mesh(node, "a mesh", keys_of("mesh"));
      const std::filesystem::path path = mesh_path(mesh);
      MeshUse& use = files_.try_emplace(path).first->second;
      use.path = path;
      use.read = mesh.find("ply") ? read_ply : read_obj;
      ++use.left;
      meshes_.push_back({&node, &use, object});
    }
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

  /// A mesh of the scene itself or of an object.
  struct MeshNode {
    const JsonNode* node;
    MeshUse* use;
    std::optional<std::size_t> object;
  };

  void read_mesh(const MeshNode& mesh_node) {
    MeshUse& use = *mesh_node.use;
    const ObjectReader reader(*mesh_node.node, "a mesh", keys_of("mesh"));
    const MeshOptions options = read_mesh_options(reader);
    const JsonNode* steps = reader.find("transform");
    const Transform transform = steps ? read_transform(*steps) : Transform{};
    if (reader.find("gltf"))
      return add_gltf(open_gltf(use.path), options, transform, builder_, mesh_node.object);
    if (!use.file) use.file = use.read(use.path, builder_.warnings);
    Mesh mesh = make_mesh(use.take(), options, materials_);
    if (steps) apply(transform, mesh);
    builder_.add(std::move(mesh), use.path, mesh_node.object);
  }

  const GltfDocument& open_gltf(const std::filesystem::path& path) {
    const auto found = documents_.find(path);
    if (found != documents_.end()) return found->second;
    return documents_.emplace(path, read_gltf(path, builder_.warnings)).first->second;
  }

  std::filesystem::path file_;
  SceneBuilder builder_;
  std::map<std::filesystem::path, GltfDocument> documents_;
  ObjMaterials materials_{builder_};
  NamedMaterials named_{file_, builder_};

  /// A member of "objects"; with an index once an instance names it.
  struct ObjectNode {
    const JsonNode* node;
    std::optional<std::size_t> index;
  };
  std::map<std::string, ObjectNode> objects_;
  std::map<std::filesystem::path, MeshUse> files_;
  std::vector<MeshNode> meshes_;
};

}  // namespace

const std::vector<SceneSection>& scene_sections() {
  static const std::vector<SceneSection> sections = [] {
    std::vector<SceneSection> all = {
        {"scene",
         {"$schema", "camera", "cameras", "image", "render", "materials", "meshes", "objects", "instances",
          "instancing", "lights", "environment"}},
        {"camera", camera_keys},
        {"light", light_keys},
        {"lens", lens_keys},
        {"image", {"width", "height"}},
        {"environment", environment_keys},
        {"sky", sky_keys},
        {"gradient", gradient_keys},
        {"map", map_keys()},
        {"index", index_keys()},
        {"absorption", absorption_keys()},
        {pair_type, pair_keys()},
        {"mesh", {"obj", "ply", "gltf", "material", "materials", "transform", "normals", "crease_angle"}},
        {"transform_step", transform_step_keys},
        {"instance", {"object", "transform", "transforms", "material"}},
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
