#include "scene/gltf_nodes.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "castray/error.h"
#include "scene/gltf_accessor.h"
#include "scene/gltf_value.h"
#include "scene/names.h"

namespace castray {

namespace {

using Json = nlohmann::ordered_json;
constexpr std::string_view nodes = "nodes";

Transform rotation_of(double x, double y, double z, double w) {
  const double size = std::sqrt(x * x + y * y + z * z + w * w);
  if (!(size > 0)) return {};
  x /= size, y /= size, z /= size, w /= size;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}},
          {}};
}

/// Columns side by side, as glTF writes matrices.
Transform matrix_of(const std::vector<double>& m) {
  return {{{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}}, {m[12], m[13], m[14]}};
}

/// Scaled, then turned by the quaternion, then moved; what is null is left out.
template <class Number>
Transform of_steps(const Number* scale, const Number* rotation, const Number* translation) {
  Transform transform;
  if (scale) transform = Transform::scale({scale[0], scale[1], scale[2]});
  if (rotation) transform = transform.then(rotation_of(rotation[0], rotation[1], rotation[2], rotation[3]));
  if (translation)
    transform = transform.then(Transform::translate({translation[0], translation[1], translation[2]}));
  return transform;
}

Transform transform_of(const GltfDocument& document, std::size_t index) {
  const tinygltf::Node& node = document.model.nodes[index];
  const auto checked = [&](const std::vector<double>& numbers, std::size_t count, const char* name) {
    if (!numbers.empty() && numbers.size() != count)
      document.fail(nodes, index, fmt::format("{} has {} numbers, not {}", name, numbers.size(), count));
    return numbers.empty() ? nullptr : numbers.data();
  };
  if (checked(node.matrix, 16, "matrix")) return matrix_of(node.matrix);
  const double* scale = checked(node.scale, 3, "scale");
  const double* rotation = checked(node.rotation, 4, "rotation");
  return of_steps(scale, rotation, checked(node.translation, 3, "translation"));
}

/// The copies of a node's mesh, in the node's space; one where it has no instances.
std::vector<Transform> instances_of(const GltfDocument& document, std::size_t index) {
  const tinygltf::Value* attributes = find_value(
      find_extension(document.model.nodes[index].extensions, "EXT_mesh_gpu_instancing"), "attributes");
  std::size_t count = 0;
  const auto read = [&](const char* name, int components) {
    const int accessor = integer_in(attributes, name, -1);
    if (accessor < 0) return std::vector<float>();
    std::vector<float> numbers = read_floats(document, accessor, components, nodes, index);
    const std::size_t elements = numbers.size() / static_cast<std::size_t>(components);
    if (count > 0 && elements != count)
      document.fail(nodes, index, fmt::format("{} of {} instances, but {} others", name, elements, count));
    count = elements;
    return numbers;
  };
  const std::vector<float> translation = read("TRANSLATION", 3), rotation = read("ROTATION", 4),
                           scale = read("SCALE", 3);
  if (count == 0) return {Transform()};
  const auto at = [](const std::vector<float>& numbers, std::size_t first) {
    return numbers.empty() ? nullptr : numbers.data() + first;
  };
  std::vector<Transform> instances;
  for (std::size_t i = 0; i < count; ++i)
    instances.push_back(of_steps(at(scale, 3 * i), at(rotation, 4 * i), at(translation, 3 * i)));
  return instances;
}

/// The nodes that the scene names; without any scene, those that are no other's child.
std::vector<int> roots_of(const GltfDocument& document) {
  const tinygltf::Model& model = document.model;
  if (!model.scenes.empty()) {
    const int scene = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (static_cast<std::size_t>(scene) >= model.scenes.size())
      throw InputError({document.path.string()}, fmt::format("scene {} is out of range: valid are 0 .. {}",
                                                             scene, model.scenes.size() - 1));
    return model.scenes[static_cast<std::size_t>(scene)].nodes;
  }
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& node : model.nodes)
    for (const int child : node.children)
      if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
        is_child[static_cast<std::size_t>(child)] = true;
  std::vector<int> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i)
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  return roots;
}

class NodeWalk {
 public:
  explicit NodeWalk(const GltfDocument& document) : document_(document), met_(document.model.nodes.size()) {}

  GltfNodes walk() {
    const std::vector<int> roots = roots_of(document_);
    push(roots, "scenes", 0, Transform());
    while (!open_.empty()) {
      const auto [index, parent] = open_.back();
      open_.pop_back();
      const tinygltf::Node& node = document_.model.nodes[index];
      const Transform to_world = transform_of(document_, index).then(parent);
      place(node, index, to_world);
      push(node.children, nodes, index, to_world);
    }
    return std::move(found_);
  }

 private:
  struct Open {
    std::size_t node;
    Transform parent;
  };

  /// The first is walked first. A node that is met twice has two parents, or is within itself.
  void push(const std::vector<int>& indices, std::string_view list, std::size_t parent,
            const Transform& to_world) {
    for (std::size_t i = indices.size(); i-- > 0;) {
      document_.at(document_.model.nodes, indices[i], nodes, list, parent);
      const auto index = static_cast<std::size_t>(indices[i]);
      if (met_[index])
        document_.fail(nodes, index, "has two parents, or is its own descendant; nodes must be a tree");
      met_[index] = true;
      open_.push_back({index, to_world});
    }
  }

  void place(const tinygltf::Node& node, std::size_t index, const Transform& to_world) {
    const auto at = [&]<class T>(const std::vector<T>& list, int object, std::string_view name) {
      document_.at(list, object, name, nodes, index);
      return static_cast<std::size_t>(object);
    };
    const tinygltf::Model& model = document_.model;
    if (node.mesh >= 0) {
      const std::size_t mesh = at(model.meshes, node.mesh, "meshes");
      for (const Transform& copy : instances_of(document_, index))
        found_.meshes.push_back({index, mesh, copy.then(to_world)});
    }
    if (node.camera >= 0)
      found_.cameras.push_back({index, at(model.cameras, node.camera, "cameras"), to_world});
    const tinygltf::Value* light = find_extension(node.extensions, "KHR_lights_punctual");
    if (const int number = integer_in(light, "light", -1); number >= 0)
      found_.lights.push_back({index, at(model.lights, number, "lights"), to_world});
  }

  const GltfDocument& document_;
  std::vector<bool> met_;
  std::vector<Open> open_;
  GltfNodes found_;
};

Json list_of(const Vec3d& v) { return Json::array({v.x, v.y, v.z}); }

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// The direction in which cameras look and lights shine: -z of their node.
Vec3d axis_of(const GltfDocument& document, const GltfPlaced& placed) {
  const Vec3d axis = placed.to_world.linear({0, 0, -1});
  if (!(length(axis) > 0) || !is_finite(axis))
    document.fail(nodes, placed.node, "has no direction: its matrix is singular");
  return normalize(axis);
}

}  // namespace

GltfNodes place_nodes(const GltfDocument& document) { return NodeWalk(document).walk(); }

Json camera_json(const GltfDocument& document, const GltfPlaced& camera) {
  const tinygltf::Camera& c = document.model.cameras[camera.object];
  const Vec3d forward = axis_of(document, camera), up = camera.to_world.linear({0, 1, 0});
  constexpr double parallel = 1e-9;
  if (!(length(cross(forward, normalize(up))) > parallel))
    document.fail(nodes, camera.node, "has no upward direction: its matrix is singular");
  const Vec3d position = camera.to_world.translation;
  Json json;
  if (c.type == "orthographic") json["type"] = c.type;
  json["position"] = list_of(position);
  json["look_at"] = list_of(position + forward);
  json["up"] = list_of(normalize(up));
  if (c.type == "orthographic") {
    if (!(c.orthographic.ymag != 0)) document.fail("cameras", camera.object, "ymag must not be 0");
    json["height"] = 2 * std::abs(c.orthographic.ymag);
  } else {
    if (!(c.perspective.yfov > 0 && c.perspective.yfov < std::numbers::pi))
      document.fail("cameras", camera.object,
                    fmt::format("yfov must be between 0 and pi, not {}", c.perspective.yfov));
    json["fov"] = degrees(c.perspective.yfov);
  }
  return json;
}

std::vector<std::string> camera_names(const GltfDocument& document, const GltfNodes& nodes) {
  std::vector<std::string> names;
  for (const GltfPlaced& camera : nodes.cameras) {
    const std::string &of_node = document.model.nodes[camera.node].name,
                      &own = document.model.cameras[camera.object].name;
    names.push_back(!of_node.empty() ? of_node : !own.empty() ? own : "camera");
  }
  return without_repeats(std::move(names));
}

double aspect_of(const GltfDocument& document, const GltfPlaced& camera) {
  const tinygltf::Camera& c = document.model.cameras[camera.object];
  if (c.type != "orthographic") return std::max(0.0, c.perspective.aspectRatio);
  return c.orthographic.ymag != 0 ? std::abs(c.orthographic.xmag / c.orthographic.ymag) : 0;
}

Json light_json(const GltfDocument& document, const GltfPlaced& light, WarningList& warnings) {
  const tinygltf::Light& l = document.model.lights[light.object];
  if (l.type != "point" && l.type != "spot" && l.type != "directional")
    document.fail(nodes, light.node, fmt::format("its light is of an unknown type '{}'", l.type));
  Vec3d intensity;
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = std::max(0.0, (i < l.color.size() ? l.color[i] : 1) * l.intensity);
    intensity[static_cast<int>(i)] =
        document.radiance(nodes, light.node, "its light has an intensity of", value);
  }
  if (l.range > 0)
    document.warn(warnings, nodes, light.node, "its light has no range: it falls off for ever");
  Json json;
  json["type"] = l.type;
  if (l.type != "directional") json["position"] = list_of(light.to_world.translation);
  if (l.type != "point") json["direction"] = list_of(axis_of(document, light));
  if (l.type == "spot") {
    constexpr double sharp = 0.999;  // the inner angle must be the smaller one
    const double outer = std::clamp(degrees(l.spot.outerConeAngle), 1e-3, 180.0);
    json["outer_angle"] = outer;
    json["inner_angle"] = std::clamp(degrees(l.spot.innerConeAngle), 0.0, sharp * outer);
  }
  json[l.type == "directional" ? "irradiance" : "intensity"] = list_of(intensity);
  return json;
}

}  // namespace castray
