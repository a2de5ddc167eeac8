// Scene files made of glTF, OBJ and PLY files show the same picture, byte for byte.
#include <catch2/catch.hpp>

#include <fstream>
#include <string>

#include "core/files.h"
#include "gltf_file.h"
#include "run_castray.h"

namespace {

namespace fs = std::filesystem;
using castray::write_file;

/// A square with an image of coverage and vertex colours, a sphere of glass that two nodes place, one of
/// rough gold; a spot and a camera.
GltfFile small_world() {
  GltfFile file;
  file.json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_transmission", "KHR_materials_volume"};
  const int leaf =
      file.add_texture(png_file(2, 8, 6, {std::string("\x10\xff\x20\xff\xff\x40\x10\x30", 8)}),
                       {{"sampler", file.add("samplers", {{"wrapS", 33071}, {"wrapT", 33071}})}});
  const int paper = file.add(
      "materials",
      {{"name", "paper"},
       {"alphaMode", "BLEND"},
       {"emissiveFactor", {0.1, 0.2, 0.3}},
       {"pbrMetallicRoughness",
        {{"metallicFactor", 0},
         {"roughnessFactor", 0.7},
         {"baseColorTexture",
          {{"index", leaf}, {"extensions", {{"KHR_texture_transform", {{"scale", {0.3, 1.7}}}}}}}}}}});
  const int glass = file.add("materials", {{"name", "paper"},
                                           {"pbrMetallicRoughness", {{"roughnessFactor", 0}}},
                                           {"extensions",
                                            {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                             {"KHR_materials_volume", {{"thicknessFactor", 1}}}}}});
  const int gold =
      file.add("materials",
               {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.7, 0.3, 1}}, {"roughnessFactor", 0.3}}}});
  nlohmann::ordered_json square = file.square(paper);
  square["attributes"]["COLOR_0"] =
      file.add_accessor<float>({{1, 1, 1}, {0.1, 0.7, 0.3}, {1, 0.2, 0.9}, {0.3, 0.3, 1}});
  file.add_node({{"mesh", file.add_mesh(square)}, {"rotation", {-0.7, 0, 0, 0.7}}, {"scale", {3, 3, 3}}});
  const int ball = file.add_sphere(glass, 8);
  file.add_node({{"mesh", ball}, {"translation", {0.3, 0.5, 0}}, {"scale", {0.5, 0.5, 0.5}}});
  file.add_node({{"mesh", ball}, {"translation", {-0.7, 0.3, 0.2}}, {"scale", {-0.3, 0.3, 0.3}}});
  file.add_node(
      {{"mesh", file.add_sphere(gold, 8)}, {"translation", {0.1, 0.7, -1.2}}, {"scale", {0.7, 0.6, 0.5}}});
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"color", {1, 0.9, 0.7}}, {"intensity", 30}, {"spot", {{"outerConeAngle", 0.7}}}}};
  file.add_node({{"translation", {0.2, 3.1, 0.4}},
                 {"rotation", {-0.7, 0.05, 0.02, 0.7}},
                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const int camera = file.add(
      "cameras",
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}, {"aspectRatio", 1.5}}}});
  file.add_node({{"camera", camera}, {"translation", {0.1, 1.3, 4.2}}, {"rotation", {-0.1, 0.02, 0, 1}}});
  return file;
}

std::string image_of(const fs::path& folder, const std::string& scene) {
  const RunResult result =
      run_castray({"render", scene, "-q", "--size", "48x32", "--spp", "4", "-o", "image.pfm"}, folder);
  INFO(result.err);
  CHECK(result.exit_code == 0);
  return file_content(folder / "image.pfm");
}

/// Converts `input` and compares the pictures.
void check_round_trip(const fs::path& folder, const std::string& input) {
  CAPTURE(input);
  const RunResult result = run_castray({"convert", input, "-o", "out.json"}, folder);
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const std::string before = image_of(folder, input);
  CHECK(before.size() > 48 * 32 * 12);
  CHECK((before == image_of(folder, "out.json")));
}

}  // namespace

TEST_CASE("a glTF file as a scene file shows the same picture, with its images beside it") {
  const TemporaryFolder folder;
  write_file(folder / "a.glb", small_world().glb());
  check_round_trip(folder.path(), "a.glb");
  CHECK(fs::exists(folder / "out_image_0.png"));
  const auto json = nlohmann::json::parse(file_content(folder / "out.json"));
  CHECK(json["camera"]["fov"].get<double>() == Approx(0.7 * 180 / std::numbers::pi));
  CHECK(json["image"] == nlohmann::json({{"width", 784}, {"height", 523}}));
  CHECK(json["lights"].size() == 1);
  CHECK(json["materials"].size() == 3);
  CHECK(json["materials"]["paper 2"]["type"] == "dielectric");
  CHECK(json["materials"]["paper"]["kd"]["image"] == "out_image_0.png");
  CHECK(json["meshes"][0]["gltf"] == "a.glb");
}

TEST_CASE("a scene file in another folder finds the glTF file and its images") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "models");
  fs::create_directories(folder / "scenes");
  GltfFile file = small_world();
  write_file(folder / "models/leaf.png", png_file(1, 8, 2, {"abc"}));
  file.json["images"][0] = {{"uri", "leaf.png"}};
  write_file(folder / "models/a.gltf", file.gltf());
  const RunResult result = run_castray({"convert", "models/a.gltf", "-o", "scenes/a.json"}, folder.path());
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const auto json = nlohmann::json::parse(file_content(folder / "scenes/a.json"));
  CHECK(json["meshes"][0]["gltf"] == "../models/a.gltf");
  CHECK(json["materials"]["paper"]["kd"]["image"] == "../models/leaf.png");
  CHECK((image_of(folder.path(), "models/a.gltf") == image_of(folder.path(), "scenes/a.json")));
}

TEST_CASE("an OBJ file with its MTL, and a PLY file, become scene files of the same picture") {
  const TemporaryFolder folder;
  write_file(folder / "grey.png", png_file(2, 8, 0, {"\x20\xf0"}));
  write_file(folder / "a.mtl",
             "newmtl wood\nKd .7 .4 .2\nKs .3 .3 .3\nNs 90\nmap_Kd -s 2 3 grey.png\nmap_Ns grey.png\n"
             "newmtl a lamp\nKe 3 2 1\n");
  write_file(folder / "a.obj",
             "mtllib a.mtl\nv 0 0 0\nv 2 0 0.1\nv 2 2 0.3\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 .5 1.3\nvt 0 0\nvt "
             "1 0\nvt 1 1\n"
             "vt 0 1\nusemtl wood\nf 1/1 2/2 3/3 4/4\nusemtl a lamp # as seen\nf 5 7 6\n");
  write_file(folder / "a.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
             "property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0.2 0 0 "
             "255\n3 0 1 2\n");
  check_round_trip(folder.path(), "a.obj");
  fs::remove(folder / "out.json");
  check_round_trip(folder.path(), "a.ply");
}

TEST_CASE("convert never writes over what it would not have written") {
  const TemporaryFolder folder;
  write_file(folder / "a.glb", small_world().glb());
  REQUIRE(run_castray({"convert", "a.glb", "-o", "out.json"}, folder.path()).exit_code == 0);
  CHECK(run_castray({"convert", "a.glb", "-o", "out.json"}, folder.path()).exit_code == 0);  // the same again
  const auto refuses = [&](const char* file) {
    const RunResult result = run_castray({"convert", "a.glb", "-o", "out.json"}, folder.path());
    CHECK(result.exit_code == 2);
    CHECK(result.err ==
          std::string("castray: error: ") + file +
              ": is there, and other than what would be written; move it, or give -o another name\n");
  };
  const std::string edited = file_content(folder / "out.json") + "// edited\n";
  write_file(folder / "out.json", edited);
  refuses("out.json");
  CHECK(file_content(folder / "out.json") == edited);
  fs::remove(folder / "out.json");
  write_file(folder / "out_image_0.png", "something else");
  refuses("out_image_0.png");
  CHECK_FALSE(fs::exists(folder / "out.json"));
  CHECK(run_castray({"convert", "a.glb", "-o", "a.png"}, folder.path()).err ==
        "castray: error: a.png: a scene becomes a scene file, whose name ends in .json\n");
  CHECK(run_castray({"convert", "a.glb", "-o", "b.json", "--exposure", "1"}, folder.path()).exit_code == 2);
}
