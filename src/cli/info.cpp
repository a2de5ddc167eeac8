#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <string>

#include "castray/image.h"
#include "castray/scene.h"
#include "cli/commands.h"
#include "cli/image_info.h"
#include "cli/scene_report.h"
#include "core/text.h"
#include "geometry/build_quality.h"
#include "materials/descriptor.h"
#include "plan/job.h"
#include "plan/plan.h"

namespace castray::cli {

namespace {

std::string text_of(const Vec3d& v) { return fmt::format("({:g}, {:g}, {:g})", v.x, v.y, v.z); }

std::string text_of(const std::array<float, 2>& v) { return fmt::format("({:g}, {:g})", v[0], v[1]); }

/// What the parameter of `key` reads of an image: "oak.png (16 x 16, srgb, uv times (2, 3))".
std::string describe(const TextureMap& map, const MaterialKey& key, const Scene& scene) {
  const Texture& texture = scene.textures[static_cast<std::size_t>(map.texture)];
  std::string text = fmt::format("{} ({} x {}", printable(texture.name), texture.width, texture.height);
  if (!texture.bytes.empty()) text += texture.color_space == ColorSpace::srgb ? ", srgb" : ", linear";
  if (map.channel != Channel::color)
    text += fmt::format(", {}", channel_names()[static_cast<std::size_t>(map.channel)]);
  if (map.scale != TextureMap().scale) text += ", uv times " + text_of(map.scale);
  if (map.offset != TextureMap().offset) text += ", uv plus " + text_of(map.offset);
  if (map.clamp) text += ", clamped";
  if (map.filter == TextureFilter::pixel) text += ", filtered by pixels";
  const bool bends = key.kind == MaterialKey::Kind::image_only;
  if (bends && map.gain != 1) text += fmt::format(", gain {:g}", map.gain);
  if (!bends && (map.base != 0 || map.gain != 1))
    text += fmt::format(", as {:g} + {:g} texel", map.base, map.gain);
  return text + ")";
}

/// "kd (1, 1, 1)"; empty where there is nothing to tell.
std::string describe(const MaterialKey& key, const Material& material, const Scene& scene) {
  using Kind = MaterialKey::Kind;
  const bool mapped = key.parameter && material.map(*key.parameter).used();
  if (key.kind == Kind::squared && !mapped) return "";  // alpha is told
  const Vec3d value = value_of(key, material);
  if (!key.brief && !mapped && value == value_of(key, Material{.name = {}})) return "";
  std::string text(key.name);
  if (key.kind == Kind::color) text += " " + text_of(value);
  if (key.kind == Kind::number) text += fmt::format(" {:g}", value.x);
  if (key.kind == Kind::squared) text += fmt::format(" {:g}", std::sqrt(value.x));
  if (!mapped) return text;
  return text + (key.kind == Kind::image_only ? " " : " times ") +
         describe(material.map(*key.parameter), key, scene);
}

std::string describe(const Material& material, const Scene& scene) {
  const MaterialDescriptor& descriptor = descriptor_of(material.type);
  std::string text(descriptor.name);
  const bool alpha_is_told = material.map(SurfaceParameter::roughness).used();
  for (const MaterialKey& key : descriptor.keys) {
    if (alpha_is_told && key.parameter == SurfaceParameter::alpha) continue;
    if (const std::string part = describe(key, material, scene); !part.empty()) text += ", " + part;
  }
  if (!material.has_back()) return text;
  return text + fmt::format("; on the back {}",
                            printable(scene.materials[static_cast<std::size_t>(material.back)].name));
}

void print_bounds(const Scene& scene) {
  const auto [low, high] = scene.bounds();
  const auto corner = [&](const Vec3d& p) { return world_point(scene, p, ", "); };
  fmt::print("bounds     ({}) .. ({})\n", corner(low), corner(high));
}

void print_geometry(const Scene& scene) {
  fmt::print("triangles  {}\n", scene.triangles.size());
  if (!scene.instances.empty())
    fmt::print("instances  {} of {} objects: {} triangles are shown\n", scene.instances.size(),
               scene.shared_meshes.size(), scene.shown_triangles());
  if (scene.expanded_instances > 0)
    fmt::print("expanded   {} instances became meshes of their own\n", scene.expanded_instances);
  fmt::print("vertices   {}\n", scene.positions.size());
  if (scene.dropped_triangles > 0)
    fmt::print("dropped    {} degenerate triangles (no area, or coordinates that are not finite)\n",
               scene.dropped_triangles);
  print_bounds(scene);
  if (!scene.triangle_normals.empty()) fmt::print("normals    {} shading normals\n", scene.normals.size());
}

std::string environment_image_text(const Scene& scene) {
  if (!scene.environment_image.used()) return "";
  const Texture& image = scene.textures[static_cast<std::size_t>(scene.environment_image.texture)];
  return fmt::format(" on average, of {}, {} x {}", printable(image.name), image.width, image.height);
}

void print_lights(const Scene& scene) {
  std::set<std::uint16_t> emitters;
  for (std::uint32_t t : scene.lights) emitters.insert(scene.triangle_material[t]);
  fmt::print("lights     {} triangles", scene.lights.size());
  for (std::uint16_t m : emitters)
    fmt::print("{} {}", m == *emitters.begin() ? ":" : ",", printable(scene.materials[m].name));
  if (!scene.delta_lights.empty()) fmt::print("; {} without size", scene.delta_lights.size());
  if (max_component(scene.environment) > 0)
    fmt::print("; environment {}{}{}", text_of(scene.environment), environment_image_text(scene),
               !scene.default_environment ? ""
               : scene.lights.empty()     ? ", as nothing in the scene emits"
                                          : ", as nothing in the scene emits more");
  fmt::print("\n");
}

void print_materials(const Scene& scene) {
  fmt::print("materials  {}\n", scene.materials.size());
  for (const Material& material : scene.materials)
    fmt::print("  {}: {}\n", printable(material.name), describe(material, scene));
}

/// What a render with default flags would choose.
void print_plan(const Scene& scene) {
  const Plan plan = make_plan(scene, {}, window_of(scene.width, scene.height, {}));
  fmt::print("kernel     {}\n", plan.kernel);
  if (!plan.list) fmt::print("tree       build {}\n", name_of(plan.build));
  fmt::print("not needed {}\n", fmt::join(plan.skipped, ", "));
}

void print_scene_info(const std::string& file, const CommonFlags& common) {
  const Scene scene = load_scene(file);
  fmt::print("scene      {}\n", file);
  print_geometry(scene);
  print_lights(scene);
  fmt::print("image      {} x {}\n", scene.width, scene.height);
  fmt::print("view       {}\n           {}\n", view_flags(scene, scene.camera),
             view_json(scene, scene.camera));
  for (std::size_t i = 0; i < scene.cameras.size() && scene.cameras.size() > 1; ++i)
    fmt::print("camera {:<3} {}\n", i, printable(scene.cameras[i].name));
  print_materials(scene);
  print_plan(scene);
  if (common.quiet) return;
  for (const std::string& key : scene.ignored_keys) fmt::print("ignored    {}\n", key);
  for (const SceneWarning& warning : scene.warnings)
    fmt::print("{}    {}\n", warning.harmless ? "note   " : "warning", warning.text());
  if (is_dark(scene)) fmt::print("warning    {}: {}\n", file, dark_scene);
}

}  // namespace

Run add_info(Arguments& arguments, const CommonFlags& common) {
  const auto files = std::make_shared<std::vector<std::string>>();
  arguments
      .add_positional(
          "FILE", *files,
          "scenes .json, .gltf, .glb, .obj or .ply, - for one on the standard input; images; films")
      .required();
  return [files, &common] {
    for (const std::string& file : *files) {
      if (file != files->front()) fmt::print("\n");
      if (file != "-" && is_image_format(file))
        print_image_info(file);
      else
        print_scene_info(file, common);
    }
    return 0;
  };
}

}  // namespace castray::cli
