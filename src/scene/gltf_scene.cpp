#include "scene/gltf_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "scene/camera_reader.h"
#include "scene/gltf_material.h"
#include "scene/gltf_mesh.h"
#include "scene/lights_reader.h"

namespace castray {

namespace {

constexpr int default_longest_side = 784;

/// The file's materials in the scene: each enters it when it is used first.
class GltfMaterials {
 public:
  GltfMaterials(const GltfDocument& document, const MeshOptions& options, SceneBuilder& builder)
      : document_(document),
        options_(options),
        builder_(builder),
        names_(material_names(document)),
        indices_(names_.size()) {
    for (const tinygltf::Mesh& mesh : document.model.meshes)
      for (const tinygltf::Primitive& primitive : mesh.primitives)
        if (primitive.attributes.contains("COLOR_0")) colored_.insert(primitive.material);
  }

  std::uint16_t of(int material, std::size_t mesh) {
    if (material >= 0) document_.at(document_.model.materials, material, "materials", "meshes", mesh);
    if (options_.material) return *options_.material;
    const std::size_t place = material < 0 ? names_.size() - 1 : static_cast<std::size_t>(material);
    used_.insert(names_[place]);
    if (const auto replaced = options_.materials.find(names_[place])) return *replaced;
    if (!indices_[place]) {
      Material made = make_material(document_, material, colored_.contains(material), builder_);
      made.name = names_[place];
      indices_[place] = builder_.add_material(std::move(made));
    }
    return *indices_[place];
  }

  /// After all meshes.
  void warn_of_unknown() const {
    options_.materials.warn_of_unknown({used_.begin(), used_.end()}, builder_.warnings);
  }

 private:
  const GltfDocument& document_;
  const MeshOptions& options_;
  SceneBuilder& builder_;
  std::vector<std::string> names_;
  std::vector<std::optional<std::uint16_t>> indices_;
  std::set<std::string_view> used_;  ///< names
  std::set<int> colored_;            ///< of primitives with colours of vertices
};

/// Whether it leaves nothing of one direction: normals then mean nothing.
bool is_flat(const Transform& transform) { return transform.determinant() == 0; }

Mesh moved(Mesh mesh, const Transform& transform) {
  if (is_flat(transform)) mesh.normals.clear(), mesh.triangle_normals.clear();
  apply(transform, mesh);
  return mesh;
}

void put_at(JsonNode& node, const SourcePlace& place) {
  node.place = node.key_place = place;
  for (JsonNode& child : node.children) put_at(child, place);
}

/// What was made of a node of the file, as a scene file would have it; its faults are told at that node.
JsonNode parsed(const nlohmann::ordered_json& json, const GltfDocument& document, const GltfPlaced& placed) {
  JsonNode made = parse_json(json.dump(), document.path.string());
  put_at(made, document.place("nodes", placed.node));
  return made;
}

void add_meshes(const GltfDocument& document, const std::vector<GltfPlaced>& meshes,
                const MeshOptions& options, const Transform& transform, SceneBuilder& builder,
                std::optional<std::size_t> object) {
  GltfMaterials materials(document, options, builder);
  std::vector<std::vector<Transform>> places(document.model.meshes.size());
  for (const GltfPlaced& placed : meshes) places[placed.object].push_back(placed.to_world.then(transform));
  bool has_faces = false;
  for (std::size_t m = 0; m < places.size(); ++m) {
    if (places[m].empty()) continue;
    const bool is_shared = !object && places[m].size() > 1 &&
                           std::ranges::none_of(places[m], [](const Transform& t) { return is_flat(t); });
    const std::optional<std::size_t> part_of = is_shared ? builder.add_object() : object;
    for (const tinygltf::Primitive& primitive : document.model.meshes[m].primitives) {
      const std::uint16_t material = materials.of(primitive.material, m);
      Mesh mesh =
          read_primitive(document, primitive, uvs_of(document, primitive.material), m, builder.warnings);
      if (mesh.triangles.empty()) continue;
      has_faces = true;
      std::ranges::fill(mesh.triangle_material, material);
      choose_normals(mesh, {}, options);
      mesh.objects = {{document.model.meshes[m].name}};
      if (is_shared)
        builder.add(std::move(mesh), document.path, part_of);
      else
        for (const Transform& place : places[m]) builder.add(moved(mesh, place), document.path, part_of);
    }
    if (is_shared)
      for (const Transform& place : places[m]) builder.place(*part_of, place);
  }
  materials.warn_of_unknown();
  if (!has_faces) builder.add({}, document.path, object);
}

}  // namespace

void add_gltf(const GltfDocument& document, const MeshOptions& options, const Transform& transform,
              SceneBuilder& builder, std::optional<std::size_t> object) {
  add_meshes(document, place_nodes(document).meshes, options, transform, builder, object);
}

std::array<int, 2> size_of_aspect(double aspect, int longest) {
  const auto shorter = [longest](double share) {
    return std::max(1, static_cast<int>(std::lround(longest * share)));
  };
  if (!(aspect > 0) || !std::isfinite(aspect)) return {longest, longest};
  if (aspect < 1) return {shorter(aspect), longest};
  return {longest, shorter(1 / aspect)};
}

Scene scene_of_gltf(const GltfDocument& document, const GltfNodes& nodes, WarningList warnings) {
  SceneBuilder builder;
  builder.warnings = std::move(warnings);
  builder.scene.file = document.path;
  builder.scene.name = document.path.stem().string();
  builder.is_asset = true;
  add_meshes(document, nodes.meshes, {}, {}, builder, {});
  for (const GltfPlaced& light : nodes.lights)
    builder.scene.delta_lights.push_back(
        read_delta_light(parsed(light_json(document, light, builder.warnings), document, light)));
  std::vector<SceneCamera>& cameras = builder.scene.cameras;
  for (const std::string& name : camera_names(document, nodes)) {
    const GltfPlaced& placed = nodes.cameras[cameras.size()];
    const auto [width, height] = size_of_aspect(aspect_of(document, placed), default_longest_side);
    cameras.push_back(
        {name, read_camera(parsed(camera_json(document, placed), document, placed)), width, height});
  }
  return builder.finish();
}

}  // namespace castray
