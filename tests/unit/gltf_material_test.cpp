// Materials of glTF files: what factors, images and extensions become.
#include <catch2/catch.hpp>

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

bool is_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) { return length(a - b) < tolerance; }

const std::string two_texels = png_file(2, 8, 6, {std::string("\xff\0\0\xff\0\xff\0\x40", 8)});
const std::string orm_texel = png_file(1, 8, 2, {std::string("\x33\x66\xcc", 3)});

/// The only material of a file with one square.
Material material_of(GltfFile& file, const Json& material, bool well = true) {
  file.add_node({{"mesh", file.add_square(file.add("materials", material))}});
  const Scene scene = well ? read_gltf_well(file) : read_gltf_scene(file.glb());
  REQUIRE(scene.materials.size() == (scene.materials[0].has_glass() ? 2 : 1));
  return scene.materials[0];
}
Material material_of(const Json& material, bool well = true) {
  GltfFile file;
  return material_of(file, material, well);
}

}  // namespace

TEST_CASE("metallic-roughness: factors, and channels of their image") {
  GltfFile file;
  const int texture = file.add_texture(orm_texel);
  const Material m = material_of(file, {{"name", "rust"},
                                        {"pbrMetallicRoughness",
                                         {{"baseColorFactor", {0.5, 0.25, 0.125, 0.3}},
                                          {"baseColorTexture", {{"index", texture}}},
                                          {"metallicFactor", 0.9},
                                          {"roughnessFactor", 0.8},
                                          {"metallicRoughnessTexture", {{"index", texture}}}}}});
  CHECK(m.name == "rust");
  CHECK(m.type == MaterialType::principled);
  CHECK(m.kd == Vec3d(0.5, 0.25, 0.125));
  CHECK(m.ks.x == Approx(0.04));
  CHECK(m.metallic == 0.9);
  CHECK(m.alpha == Approx(0.64));
  CHECK(m.coverage == 1);  // OPAQUE
  CHECK_FALSE(m.map(SurfaceParameter::coverage).used());
  CHECK(m.map(SurfaceParameter::metallic).channel == Channel::blue);
  CHECK(m.map(SurfaceParameter::roughness).channel == Channel::green);
  CHECK(m.map(SurfaceParameter::roughness).texture == m.map(SurfaceParameter::metallic).texture);
  CHECK(m.map(SurfaceParameter::kd).texture != m.map(SurfaceParameter::metallic).texture);  // sRGB
}

TEST_CASE("what is no metal is a coated base, no coat, no coat") {
  const Material plastic = material_of({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  CHECK(plastic.type == MaterialType::microfacet);
  CHECK(plastic.ks.x == Approx(0.04));
  CHECK(plastic.alpha == 1);
  const Material chalk = material_of({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                                      {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}});
  CHECK(chalk.type == MaterialType::diffuse);
  const Material diamond = material_of(
      {{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
       {"extensions",
        {{"KHR_materials_ior", {{"ior", 2.0}}},
         {"KHR_materials_specular", {{"specularColorFactor", {1, 0.5, 0.25}}, {"specularFactor", 0.5}}}}}});
  CHECK(is_near(diamond.ks, Vec3d(1, 0.5, 0.25) / 18));
  GltfFile file;
  file.add_node({{"mesh", file.add_square()}});
  const Material none = read_gltf_well(file).materials[0];
  CHECK(none.name == "default");
  CHECK(none.metallic == 1);
  CHECK(none.alpha == 1);
  CHECK(none.kd == Vec3d(1));
}

TEST_CASE("alpha is coverage where it is blended, a threshold where it masks, and nothing else") {
  GltfFile blended, masked;
  const auto with = [](GltfFile& file, const char* mode) -> Json {
    return {{"alphaMode", mode},
            {"alphaCutoff", 0.75},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {1, 1, 1, 0.5}},
              {"baseColorTexture", {{"index", file.add_texture(two_texels)}}}}}};
  };
  const TextureMap blend = material_of(blended, with(blended, "BLEND")).map(SurfaceParameter::coverage);
  CHECK(blend.channel == Channel::alpha);
  CHECK(blend.gain == 0.5f);
  CHECK(blend.base == 0);
  const TextureMap mask = material_of(masked, with(masked, "MASK")).map(SurfaceParameter::coverage);
  CHECK(mask.base + mask.gain * 1.5f == 1);                        // alpha 0.75
  CHECK(mask.base + mask.gain * (1.5f - 2 / 256.f) == Approx(0));  // one step of 8 bits less
  const auto coverage = [](const char* mode, double alpha) {
    return material_of(
               {{"alphaMode", mode}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}})
        .coverage;
  };
  CHECK(coverage("OPAQUE", 0.25) == 1);
  CHECK(coverage("BLEND", 0.25) == 0.25);
  CHECK(coverage("MASK", 0.25) == 0);
  CHECK(coverage("MASK", 0.5) == 1);
}

TEST_CASE("emission: factor, strength, image, on both sides where the material has two") {
  GltfFile file;
  const int texture = file.add_texture(two_texels);
  const Material m =
      material_of(file, {{"emissiveFactor", {1, 0.5, 0}},
                         {"emissiveTexture", {{"index", texture}}},
                         {"doubleSided", true},
                         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}});
  CHECK(m.ke == Vec3d(20, 10, 0));
  CHECK(m.map(SurfaceParameter::ke).used());
  CHECK(m.two_sided_emission);
  CHECK_FALSE(material_of({{"emissiveFactor", {1, 1, 1}}}).two_sided_emission);
}

TEST_CASE("glass, clear coat, sheen, specular-glossiness and unlit") {
  const Material glass = material_of(
      {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1, 1}}, {"roughnessFactor", 0}}},
       {"extensions",
        {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
         {"KHR_materials_volume",
          {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {1, 0.5, 0}}}},
         {"KHR_materials_ior", {{"ior", 1.33}}}}}});
  CHECK(glass.type == MaterialType::dielectric);
  CHECK(glass.ior == 1.33);
  CHECK(glass.alpha == 0);
  CHECK(glass.transmittance == Vec3d(0.5, 1, 1));
  CHECK(glass.absorption.x == Approx(0).margin(1e-12));
  CHECK(glass.absorption.y == Approx(std::log(2.) / 2));
  CHECK(glass.absorption.z > 5);

  const Material half = material_of(
      {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1, 1}}, {"metallicFactor", 0.25}}},
       {"extensions",
        {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
         {"KHR_materials_volume",
          {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {1, 0.5, 1}}}},
         {"KHR_materials_ior", {{"ior", 1.33}}}}}});
  CHECK(half.type == MaterialType::principled);
  CHECK((half.transmission == 0.5 && half.metallic == 0.25 && half.ior == 1.33));
  CHECK(half.absorption.y == Approx(std::log(2.) / 2));

  GltfFile file;
  const int texture = file.add_texture(orm_texel);
  const Material coat = material_of(file, {{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                                           {"extensions",
                                            {{"KHR_materials_clearcoat",
                                              {{"clearcoatFactor", 0.75},
                                               {"clearcoatRoughnessFactor", 0.5},
                                               {"clearcoatRoughnessTexture", {{"index", texture}}}}}}}});
  CHECK(coat.type == MaterialType::principled);
  CHECK(coat.clearcoat == 0.75);
  CHECK(coat.clearcoat_roughness == 0.5);
  CHECK(coat.map(SurfaceParameter::clearcoat_roughness).channel == Channel::green);

  const Material cloth = material_of(
      {{"extensions", {{"KHR_materials_sheen", {{"sheenColorFactor", {0.5, 0.5, 0.5}}}}}}}, false);
  CHECK(cloth.sheen == Approx(0.5));

  GltfFile old;
  const int gloss = old.add_texture(two_texels);
  const Material m = material_of(old, {{"extensions",
                                        {{"KHR_materials_pbrSpecularGlossiness",
                                          {{"diffuseFactor", {0.5, 0.5, 0.5, 1}},
                                           {"specularFactor", {0.25, 0.25, 0.25}},
                                           {"glossinessFactor", 0.5},
                                           {"specularGlossinessTexture", {{"index", gloss}}}}}}}});
  CHECK(m.type == MaterialType::microfacet);
  CHECK(m.kd == Vec3d(0.5));
  CHECK(m.ks == Vec3d(0.25));
  CHECK(m.map(SurfaceParameter::ks).used());
  const TextureMap& rough = m.map(SurfaceParameter::roughness);
  CHECK(rough.channel == Channel::alpha);
  CHECK(rough.base + rough.gain == 0.5f);  // alpha 1

  const Material pane =
      material_of({{"pbrMetallicRoughness", {{"roughnessFactor", 0}}},
                   {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}}}});
  CHECK(pane.type == MaterialType::dielectric);
  CHECK((pane.thin && pane.ior == 1.5 && pane.coverage == 1));

  const Material unlit = material_of({{"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0.5, 1, 1}}}},
                                      {"extensions", {{"KHR_materials_unlit", Json::object()}}}},
                                     false);
  CHECK(unlit.ke == Vec3d(0.25, 0.5, 1));
  CHECK(unlit.kd == Vec3d());
  CHECK(unlit.two_sided_emission);
}

TEST_CASE("KHR_materials_anisotropy: alpha across the lobe's direction, and along it nearer to 1") {
  GltfFile file;
  const Material m =
      material_of(file, {{"pbrMetallicRoughness", {{"roughnessFactor", 0.5}}},
                         {"extensions",
                          {{"KHR_materials_anisotropy",
                            {{"anisotropyStrength", 0.5}, {"anisotropyRotation", std::numbers::pi / 2}}}}}});
  const double across = 0.25, along = across + (1 - across) * 0.25, ratio = 1 - m.anisotropy;
  CHECK(m.type == MaterialType::principled);
  CHECK(m.alpha / std::sqrt(ratio) == Approx(along));
  CHECK(m.alpha * std::sqrt(ratio) == Approx(across));
  CHECK(m.anisotropy_rotation == Approx(90));
}

TEST_CASE("KHR_materials_anisotropy: red and green are the direction, blue is a factor of the strength") {
  const auto read = [](const std::string& texels, int width, const Json& pbr, const std::string& rough = {}) {
    GltfFile file;
    Json surface = pbr;
    if (!rough.empty())
      surface["metallicRoughnessTexture"] = {{"index", file.add_texture(png_file(2, 8, 2, {rough}))}};
    const Json extension = {
        {"anisotropyStrength", 0.5},
        {"anisotropyTexture", {{"index", file.add_texture(png_file(width, 8, 2, {texels}))}}}};
    file.add_node({{"mesh", file.add_square(file.add(
                                "materials", {{"pbrMetallicRoughness", surface},
                                              {"extensions", {{"KHR_materials_anisotropy", extension}}}}))}});
    return read_gltf_scene(file.glb());
  };
  const auto check_at = [](const Scene& scene, int texel_number, double across, double strength) {
    const Material& m = scene.materials[0];
    const auto value = [&](SurfaceParameter p) {
      const Texture& image = scene.textures[static_cast<std::size_t>(m.map(p).texture)];
      return image.bytes[static_cast<std::size_t>(texel_number)] / 255.0;
    };
    const double alpha = m.alpha * std::pow(value(SurfaceParameter::roughness), 2);
    const double ratio = 1 - m.anisotropy * value(SurfaceParameter::anisotropy);
    CHECK(alpha / std::sqrt(ratio) == Approx(across + (1 - across) * strength * strength).epsilon(0.03));
    CHECK(alpha * std::sqrt(ratio) == Approx(across).epsilon(0.03));
  };
  const std::string same("\x00\x80\x80\xff\x80\x80", 6), two("\xff\x80\xff\xff\x80\x80", 6);
  const double half = 0x80 / 255.0;

  // One strength everywhere needs no images, even where there is a base below.
  const Scene one = read(same, 2, {{"roughnessFactor", 0.5}, {"metallicFactor", 0.5}});
  CHECK(one.warnings.empty());
  CHECK_FALSE(one.materials[0].map(SurfaceParameter::anisotropy).used());
  CHECK(one.materials[0].map(SurfaceParameter::anisotropy_direction).used());
  const double along = 0.25 + 0.75 * std::pow(0.5 * half, 2);
  CHECK(1 - one.materials[0].anisotropy == Approx(0.25 / along));

  const Scene metal = read(two, 2, {{"roughnessFactor", 0.5}});
  CHECK(metal.warnings.empty());
  check_at(metal, 0, 0.25, 0.5);
  check_at(metal, 1, 0.25, 0.5 * half);

  const std::string roughness("\x00\xff\xff\x00\x80\xff", 6);
  const Scene rough = read(two, 2, {{"roughnessFactor", 0.8}}, roughness);
  CHECK(rough.warnings.empty());
  check_at(rough, 0, 0.64, 0.5);
  check_at(rough, 1, std::pow(0.8 * half, 2), 0.5 * half);

  const Scene blend = read(two, 2, {{"roughnessFactor", 0.5}, {"metallicFactor", 0.5}});
  REQUIRE(blend.warnings.size() == 1);
  CHECK(blend.warnings[0].message.find("strength is the same everywhere") != std::string::npos);
  CHECK(blend.materials[0].anisotropy > 0);
  CHECK_FALSE(blend.materials[0].map(SurfaceParameter::anisotropy).used());

  const Scene over_base = read(two, 2, {{"roughnessFactor", 0.5}, {"metallicFactor", 0.5}}, roughness);
  REQUIRE(over_base.warnings.size() == 1);
  CHECK(over_base.warnings[0].message.find("left out beside an image of the roughness") != std::string::npos);
  CHECK(over_base.materials[0].anisotropy == 0);
}

TEST_CASE("KHR_texture_transform: scale and offset are the map's, a turn is the mesh's") {
  const auto with = [](GltfFile& file, const Json& transform) -> Json {
    return {{"pbrMetallicRoughness",
             {{"baseColorTexture",
               {{"index", file.add_texture(two_texels)},
                {"extensions", {{"KHR_texture_transform", transform}}}}}}}};
  };
  GltfFile file;
  const Material m = material_of(file, with(file, {{"scale", {2, 4}}, {"offset", {0.25, 0.5}}}));
  const TextureMap& map = m.map(SurfaceParameter::kd);
  CHECK(map.scale == std::array<float, 2>{2, 4});
  // v of glTF, 0 at the top: 4 v + 0.5 = 1 - (4 (1 - v) + offset)
  CHECK(map.offset == std::array<float, 2>{0.25f, 1 - 4 - 0.5f});

  GltfFile turned;
  turned.add_node({{"mesh", turned.add_square(turned.add(
                                "materials", with(turned, {{"rotation", std::numbers::pi / 2}})))}});
  const Scene scene = read_gltf_well(turned);
  CHECK(scene.materials[0].map(SurfaceParameter::kd).scale == std::array<float, 2>{1, 1});
  // The lower left corner, (0,1) in the file, is (1,0) there after a quarter turn: the upper right one.
  CHECK(scene.uvs[0][0] == Approx(1).margin(1e-6));
  CHECK(scene.uvs[0][1] == Approx(1).margin(1e-6));
}

TEST_CASE("normal maps have a strength, images may use the second texture coordinates") {
  GltfFile file;
  const int texture = file.add_texture(orm_texel);
  Json primitive = file.square(
      file.add("materials", {{"normalTexture", {{"index", texture}, {"scale", 0.5}, {"texCoord", 1}}}}));
  primitive["attributes"]["TEXCOORD_1"] = file.add_accessor<float>({{5, 0}, {6, 0}, {6, 1}, {5, 1}});
  file.add_node({{"mesh", file.add_mesh(primitive)}});
  const Scene scene = read_gltf_well(file);
  CHECK(scene.materials[0].map(SurfaceParameter::normal).gain == 0.5f);
  CHECK(scene.uvs[0][0] == 5);
}

TEST_CASE("images are in the buffer, in data URIs, or in files with escaped names") {
  for (const char* uri : {"my%20image.png", "data"}) {
    const TemporaryFolder folder;
    write_file(folder / "my image.png", two_texels);
    GltfFile file;
    const int image =
        file.add("images",
                 {{"uri", uri == std::string("data") ? "data:image/png;base64," + base64(two_texels) : uri}});
    const int texture = file.add("textures", {{"source", image}});
    const int material =
        file.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
    file.add_node({{"mesh", file.add_square(material)}});
    write_file(folder / "t.gltf", file.gltf());
    const Scene scene = load_scene(folder / "t.gltf");
    CHECK(scene.warnings.empty());
    REQUIRE(scene.textures.size() == 1);
    CHECK(scene.textures[0].width == 2);
    CHECK(scene.textures[0].bytes.size() == 8);
  }
}

TEST_CASE("emission and indices are kept within what kernels compute with") {
  const auto glowing = [](double strength) {
    return Json{{"emissiveFactor", {1, 0.5, 0}},
                {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", strength}}}}}};
  };
  CHECK(is_near(material_of(glowing(1e20)).ke / 1e20, {1, 0.5, 0}));
  CHECK(material_of(glowing(1e-40)).ke == Vec3d());
  CHECK_THROWS_WITH(
      material_of(glowing(1e39)),
      Catch::Contains("materials[0]: it emits 1e+39; it must be 0, or at least 1e-30 and at most"));
  const Material glass = material_of({{"extensions",
                                       {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                        {"KHR_materials_volume", {{"thicknessFactor", 1}}},
                                        {"KHR_materials_ior", {{"ior", 1e9}}}}}});
  CHECK(glass.ior == 1e4);
}
