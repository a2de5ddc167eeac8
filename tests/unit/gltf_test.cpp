// glTF files, made by the tests themselves, read into scenes: what each feature of the format becomes.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "castray/error.h"
#include "core/files.h"
#include "gltf_scene.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

using Json = GltfFile::Json;

Vec3d corner(const Scene& scene, std::size_t triangle, std::size_t i) {
  return scene.to_world(Vec3d(scene.positions[scene.triangles[triangle][i]]));
}

Vec3d normal_of(const Scene& scene, std::size_t triangle) {
  const Vec3d a = corner(scene, triangle, 0);
  return normalize(cross(corner(scene, triangle, 1) - a, corner(scene, triangle, 2) - a));
}

bool is_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) { return length(a - b) < tolerance; }

bool warns_of(const Scene& scene, const std::string& what) {
  return std::ranges::any_of(
      scene.warnings, [&](const SceneWarning& w) { return w.message.find(what) != std::string::npos; });
}

}  // namespace

TEST_CASE(
    "a glTF file is the same as .glb, as .gltf with a data URI, and with a buffer in a file of its own") {
  GltfFile file;
  file.add_node({{"mesh", file.add_square()}});
  const Scene binary = read_gltf_scene(file.glb()), text = read_gltf_scene(file.gltf(), "t.gltf");
  const TemporaryFolder folder;
  write_file(folder / "a b.bin", file.bytes + "longer than the buffer");
  Json json = file.json;
  json["buffers"] = {{{"byteLength", file.bytes.size()}, {"uri", "a%20b.bin"}}};
  write_file(folder / "t.gltf", json.dump());
  const Scene beside = load_scene(folder / "t.gltf");
  for (const Scene* scene : {&binary, &text, &beside}) {
    CHECK(scene->triangles.size() == 2);
    CHECK(scene->positions == binary.positions);
    CHECK(scene->uvs == binary.uvs);
    CHECK(scene->default_environment);
    CHECK_FALSE(scene->has_camera);
    CHECK(is_near(normal_of(*scene, 0), {0, 0, 1}));
  }
  CHECK(binary.uvs[0] == std::array<float, 2>{0, 0});  // v of glTF grows downwards
  CHECK(binary.uvs[2] == std::array<float, 2>{1, 1});
}

TEST_CASE("triangles come from lists, strips and fans, with indices of every type or without") {
  const GltfFile::Points corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}};
  struct Mode {
    int mode;
    std::vector<double> order;
    std::size_t triangles;
  };
  const Mode modes[] = {{4, {0, 1, 2, 2, 1, 3}, 2}, {5, {0, 1, 2, 3, 4}, 3}, {6, {0, 1, 3, 2}, 2}};
  for (const auto& [mode, order, triangles] : modes)
    for (const char* type : {"ubyte", "ushort", "uint", "none"}) {
      CAPTURE(mode, type);
      GltfFile file;
      Json primitive = {{"mode", mode}};
      if (type == std::string("none")) {
        GltfFile::Points in_order;
        for (const double i : order) in_order.push_back(corners[static_cast<std::size_t>(i)]);
        primitive["attributes"]["POSITION"] = file.add_accessor<float>(in_order);
      } else {
        primitive["attributes"]["POSITION"] = file.add_accessor<float>(corners);
        primitive["indices"] = type == std::string("ubyte")    ? file.add_indices<std::uint8_t>(order)
                               : type == std::string("ushort") ? file.add_indices<std::uint16_t>(order)
                                                               : file.add_indices<std::uint32_t>(order);
      }
      file.add_node({{"mesh", file.add_mesh(primitive)}});
      const Scene scene = read_gltf_well(file);
      REQUIRE(scene.triangles.size() == triangles);
      CHECK(scene.triangle_normals.empty());
      for (std::size_t t = 0; t < triangles; ++t) CHECK(is_near(normal_of(scene, t), {0, 0, 1}));
    }
}

TEST_CASE("accessors may be interleaved, sparse, or of normalised whole numbers") {
  GltfFile file;
  // position, colour, texture coordinate of each vertex, 20 bytes apart
  std::string vertices;
  const double at[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  for (const auto& [x, y] : at)
    vertices += GltfFile::packed<float>({{x, y, 0}}) +
                GltfFile::packed<std::uint8_t>({{255 * x, 51, 255 * y, 255}}) +
                GltfFile::packed<std::uint16_t>({{65535 * x, 65535 * y}});
  const int view = file.add_view(vertices, {{"byteStride", 20}});
  const auto accessor = [&](int offset, int component_type, const char* type, bool normalized) {
    return file.add("accessors", {{"bufferView", view},
                                  {"byteOffset", offset},
                                  {"componentType", component_type},
                                  {"type", type},
                                  {"normalized", normalized},
                                  {"count", 4}});
  };
  const int positions = accessor(0, 5126, "VEC3", false);
  const int moved = file.add_view(GltfFile::packed<float>({{1, 1, 5}}));
  const int which = file.add_view(GltfFile::packed<std::uint8_t>({{3}}));
  file.json["accessors"][static_cast<std::size_t>(positions)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", which}, {"componentType", 5121}}},
      {"values", {{"bufferView", moved}}}};
  file.add_node({{"mesh", file.add_mesh({{"attributes",
                                          {{"POSITION", positions},
                                           {"COLOR_0", accessor(12, 5121, "VEC4", true)},
                                           {"TEXCOORD_0", accessor(16, 5123, "VEC2", true)}}},
                                         {"mode", 5}})}});
  const Scene scene = read_gltf_well(file);
  CHECK(is_near(corner(scene, 0, 0), {0, 0, 0}));
  CHECK(is_near(corner(scene, 1, 1), {1, 1, 5}));  // the sparse one
  CHECK(is_near(Vec3d(scene.colors[1]), {1, 0.2, 0}));
  CHECK(is_near(Vec3d(scene.colors[2]), {0, 0.2, 1}));
  CHECK(scene.uvs[1] == std::array<float, 2>{1, 1});
  CHECK(scene.materials[0].vertex_colors);
}

TEST_CASE("KHR_mesh_quantization: positions and normals of whole numbers, signed ones down to -1") {
  GltfFile file;
  file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.add_node(
      {{"mesh",
        file.add_mesh(
            {{"attributes",
              {{"POSITION", file.add_accessor<std::int16_t>({{-300, 0, 0}, {300, 0, 0}, {0, 300, 0}})},
               {"NORMAL", file.add_accessor<std::int8_t>({{0, 0, 127}, {0, 0, 127}, {-128, 0, 127}},
                                                         {{"normalized", true}})}}}})}});
  const Scene scene = read_gltf_well(file);
  CHECK(is_near(corner(scene, 0, 1), {300, 0, 0}, 1e-4));
  CHECK(is_near(Vec3d(scene.normals[2]), {-std::sqrt(0.5), 0, std::sqrt(0.5)}));
}

TEST_CASE("nodes are moved by matrices and by scale, rotation and translation, parents last") {
  const double half = std::sqrt(0.5);
  GltfFile file;
  const int mesh = file.add_square();
  const int child = file.add("nodes", {{"mesh", mesh}, {"translation", {10, 0, 0}}});
  file.add_node({{"children", {child}},
                 {"rotation", {0, half, 0, half}},
                 {"scale", {2, 2, 2}},
                 {"translation", {0, 1, 0}}});
  file.add_node({{"mesh", mesh}, {"matrix", {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 6, 7, 1}}});
  const Scene scene = read_gltf_well(file);
  REQUIRE(scene.triangles.size() == 4);
  // (-1,-1,0) + (10,0,0), doubled, a quarter turn about +y, up by 1
  CHECK(is_near(corner(scene, 0, 0), {0, -1, -18}, 1e-5));
  CHECK(is_near(normal_of(scene, 0), {1, 0, 0}, 1e-5));
  CHECK(is_near(corner(scene, 2, 0), {5, 5, 8}, 1e-5));
  CHECK(is_near(normal_of(scene, 2), {1, 0, 0}, 1e-5));
}

TEST_CASE("a node that mirrors keeps the outward side outward") {
  GltfFile file;
  const int mesh = file.add_square();
  file.add_node({{"mesh", mesh}, {"scale", {-1, 1, 1}}});
  file.add_node({{"mesh", mesh}, {"scale", {1, 1, -1}}, {"translation", {0, 0, 3}}});
  const Scene scene = read_gltf_well(file);
  CHECK(is_near(normal_of(scene, 0), {0, 0, 1}));
  CHECK(is_near(normal_of(scene, 2), {0, 0, -1}));
  for (std::size_t t = 0; t < 4; ++t)
    CHECK(is_near(Vec3d(scene.normals[scene.triangle_normals[t][0]]), normal_of(scene, t)));
}

TEST_CASE("EXT_mesh_gpu_instancing: a mesh is where each instance puts it") {
  GltfFile file;
  file.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const int at = file.add_accessor<float>({{0, 0, 0}, {10, 0, 0}, {0, 20, 0}});
  const int scale = file.add_accessor<float>({{1, 1, 1}, {2, 2, 2}, {1, 1, 1}});
  file.add_node({{"mesh", file.add_square()},
                 {"translation", {0, 0, 4}},
                 {"extensions",
                  {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", at}, {"SCALE", scale}}}}}}}});
  const Scene scene = read_gltf_well(file);
  REQUIRE(scene.triangles.size() == 6);
  CHECK(is_near(corner(scene, 2, 0), {8, -2, 4}, 1e-5));
  CHECK(is_near(corner(scene, 4, 0), {-1, 19, 4}, 1e-5));
}

TEST_CASE("the first camera is the scene's, with its width over height") {
  GltfFile file;
  const double half = std::sqrt(0.5);
  file.add_node({{"mesh", file.add_square()}});
  const int camera = file.add(
      "cameras",
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", 2.0}}}});
  const int inner = file.add("nodes", {{"camera", camera}, {"translation", {0, 0, 5}}});
  file.add_node({{"children", {inner}}, {"rotation", {0, half, 0, half}}, {"scale", {2, 2, 2}}});
  file.add_orthographic(3);
  const Scene scene = read_gltf_well(file);
  REQUIRE(scene.has_camera);
  const Camera world = scene.to_world(scene.camera);
  CHECK(world.projection == Projection::perspective);
  CHECK(is_near(world.position, {10, 0, 0}));
  CHECK(is_near(world.forward, {-1, 0, 0}));
  CHECK(is_near(world.up, {0, 1, 0}));
  CHECK(world.tan_half_fov == Approx(std::tan(0.25)));
  CHECK(scene.width == 784);
  CHECK(scene.height == 392);

  GltfFile flat;
  flat.add_node({{"mesh", flat.add_square()}});
  flat.add_orthographic(3);
  const Scene orthographic = read_gltf_well(flat);
  CHECK(orthographic.camera.projection == Projection::orthographic);
  CHECK(orthographic.to_world(orthographic.camera).half_height == Approx(3));
}

TEST_CASE("KHR_lights_punctual: point, spot and directional, in the file's units") {
  GltfFile file;
  file.json["extensionsUsed"] = {"KHR_lights_punctual"};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 100}},
      {{"type", "spot"}, {"intensity", 10}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}},
      {{"type", "directional"}, {"intensity", 3}}};
  file.add_node({{"mesh", file.add_square()}});
  const auto add = [&](int light, const Json& node) {
    Json all = node;
    all["extensions"]["KHR_lights_punctual"]["light"] = light;
    file.add_node(all);
  };
  const double half = std::sqrt(0.5);
  add(0, {{"translation", {1, 2, 3}}, {"scale", {7, 7, 7}}});
  add(1, {{"translation", {0, 0, 4}}});
  add(2, {{"rotation", {-half, 0, 0, half}}});
  const Scene scene = read_gltf_well(file);
  REQUIRE(scene.delta_lights.size() == 3);
  CHECK_FALSE(scene.default_environment);
  const auto light = [&](std::size_t i) { return scene.to_world(scene.delta_lights[i]); };
  CHECK(light(0).kind == DeltaLight::Kind::point);
  CHECK(is_near(light(0).position, {1, 2, 3}));
  CHECK(is_near(light(0).intensity, {100, 50, 25}, 1e-4));
  CHECK(light(1).kind == DeltaLight::Kind::spot);
  CHECK(is_near(light(1).direction, {0, 0, -1}));
  CHECK(light(1).cos_outer == Approx(std::cos(0.6)));
  CHECK(light(1).cos_inner == Approx(std::cos(0.2)));
  CHECK(light(2).kind == DeltaLight::Kind::directional);
  CHECK(is_near(light(2).direction, {0, -1, 0}));
  CHECK(is_near(light(2).intensity, {3, 3, 3}));
}

TEST_CASE("what is odd is told once and left out") {
  GltfFile file;
  const int missing = file.add("textures", {{"source", file.add("images", {{"uri", "nowhere.png"}})}});
  const int broken = file.add_texture("no image");
  file.json["extensionsUsed"] = {"KHR_materials_iridescence", "KHR_xmp_json_ld"};
  const int material = file.add("materials", {{"pbrMetallicRoughness",
                                               {{"baseColorTexture", {{"index", missing}}},
                                                {"metallicRoughnessTexture", {{"index", broken}}},
                                                {"roughnessFactor", 7}}}});
  const int mesh = file.add_square(material);
  file.json["meshes"][0]["primitives"].push_back({{"mode", 1}, {"attributes", {{"POSITION", 0}}}});
  file.add_node({{"mesh", mesh}});
  file.add_node({{"mesh", mesh}, {"translation", {0, 0, 1}}});
  const Scene scene = read_gltf_scene(file.glb());
  CHECK(scene.triangles.size() == 4);
  CHECK(warns_of(scene, "no such file: nowhere.png"));
  CHECK(warns_of(scene, "materials[0]: an image is left out: "));
  CHECK(warns_of(scene, "roughnessFactor 7 is outside of 0 .. 1"));
  CHECK(warns_of(scene, "points and lines are left out"));
  CHECK(warns_of(scene, "the extension KHR_materials_iridescence is not read"));
  const auto xmp = std::ranges::find_if(
      scene.warnings, [](const SceneWarning& w) { return w.message.find("KHR_xmp") != std::string::npos; });
  REQUIRE(xmp != scene.warnings.end());
  CHECK(xmp->harmless);
  CHECK(scene.materials[0].alpha == 1);
}

TEST_CASE("a scene file places a glTF file as a mesh, and may replace its materials") {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_node({{"mesh", file.add_square(file.add("materials", {{"name", "paint"}}))}});
  file.add_node(
      {{"mesh", file.add_square(file.add("materials", {{"name", "paint"}}))}, {"translation", {0, 0, 1}}});
  file.add_orthographic(3);
  write_file(folder / "a.glb", file.glb());
  const auto scene_with = [&](const std::string& more) {
    write_file(folder / "s.json", R"({ "materials": { "red": { "type": "diffuse", "kd": [1, 0, 0] } },
      "meshes": [ { "gltf": "a.glb", "transform": [ { "scale": 2 } ])" +
                                      more + " } ] }");
    return load_scene(folder / "s.json");
  };
  const Scene own = scene_with("");
  CHECK(own.triangles.size() == 4);
  CHECK_FALSE(own.has_camera);
  CHECK(is_near(corner(own, 0, 0), {-2, -2, 0}));
  CHECK(own.material_of(0).name == "paint");
  CHECK(own.material_of(2).name == "paint 2");
  const Scene one = scene_with(R"(, "materials": { "paint 2": "red" })");
  CHECK(one.material_of(0).name == "paint");
  CHECK(one.material_of(2).name == "red");
  CHECK(scene_with(R"(, "material": "red", "normals": "face")").triangle_normals.empty());
}
