// What the features of glTF look like: small pictures of files after the format's feature tests, with values
// that the text of the format gives.
#include <catch2/catch.hpp>

#include <numbers>
#include <string>
#include <vector>

#include "castray/render.h"
#include "gltf_scene.h"

using namespace castray;

namespace {

using Json = GltfFile::Json;

constexpr int side = 16;

/// A square picture; where nothing else gives light, the environment is black.
Image picture(const GltfFile& file, std::uint64_t spp = 4, const Vec3d& environment = {}) {
  Scene scene = read_gltf_scene(file.glb());
  scene.width = scene.height = side;
  scene.environment = environment;
  scene.default_environment = false;
  RenderOptions options;
  options.samples = {0, spp};
  return image_of(render(scene, options).film);
}

/// The pixel at (x,y) of an image of 1 x 1, y downwards.
Vec3d at(const Image& image, double x, double y) {
  return Vec3d(image.at(static_cast<int>(x * side), static_cast<int>(y * side)));
}

Vec3d mean(const Image& image) {
  Vec3d sum;
  for (const Vec3f& pixel : image.pixels) sum = sum + Vec3d(pixel);
  return sum / double(side * side);
}

bool is_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-3) {
  return max_component(Vec3d(std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z))) < tolerance;
}

const Vec3d red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1}, white{1, 1, 1}, black;

/// Red and green above blue and white, each of 2 x 2 texels.
std::string four_colors() {
  const std::string r("\xff\0\0", 3), g("\0\xff\0", 3), b("\0\0\xff", 3), w("\xff\xff\xff", 3);
  const std::string above = r + r + g + g, below = b + b + w + w;
  return png_file(4, 8, 2, {above, above, below, below});
}

/// A material that is seen as its image, whatever the light.
Json seen_as_image(GltfFile& file, const Json& info = Json::object(), const Json& texture = Json::object()) {
  Json all = info;
  all["index"] = file.add_texture(four_colors(), texture);
  return {{"pbrMetallicRoughness", {{"baseColorTexture", all}}},
          {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
}

/// A square that fills the picture.
Image picture_of(GltfFile& file, const Json& material, std::uint64_t spp = 4) {
  file.add_node({{"mesh", file.add_square(file.add("materials", material))}});
  file.add_orthographic(1);
  return picture(file, spp);
}

Json transform(const Json& members) { return {{"extensions", {{"KHR_texture_transform", members}}}}; }

/// Reflects half of the light, in all directions alike.
const Json chalk = {
    {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicFactor", 0}}},
    {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};

void add_light(GltfFile& file, const Json& light, const Json& node) {
  Json all = node;
  Json& lights = file.json["extensions"]["KHR_lights_punctual"]["lights"];
  lights.push_back(light);
  all["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
  file.add_node(all);
}

}  // namespace

TEST_CASE("an image stands upright on its square, and mirrored where the node mirrors") {
  GltfFile upright;
  const Image image = picture_of(upright, seen_as_image(upright));
  CHECK(is_near(at(image, .25, .25), red));
  CHECK(is_near(at(image, .75, .25), green));
  CHECK(is_near(at(image, .25, .75), blue));
  CHECK(is_near(at(image, .75, .75), white));
  GltfFile mirrored;
  mirrored.add_node({{"mesh", mirrored.add_square(mirrored.add("materials", seen_as_image(mirrored)))},
                     {"scale", {-1, 1, 1}}});
  mirrored.add_orthographic(1);
  CHECK(is_near(at(picture(mirrored), .25, .25), green));
  CHECK(is_near(at(picture(mirrored), .25, .75), white));
}

TEST_CASE("light leaves the side that is outward, also of a node that mirrors") {
  const auto shines = [](const Json& scale, bool double_sided) {
    GltfFile file;
    const int lamp = file.add(
        "materials", {{"emissiveFactor", {1, 0.5, 0.25}},
                      {"doubleSided", double_sided},
                      {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}});
    file.add_node({{"mesh", file.add_square(lamp)}, {"scale", scale}});
    file.add_orthographic(1);
    return at(picture(file), .5, .5);
  };
  CHECK(is_near(shines({1, 1, 1}, false), {20, 10, 5}));
  CHECK(is_near(shines({-1, 1, 1}, false), {20, 10, 5}));
  CHECK(is_near(shines({1, 1, -1}, false), black));
  CHECK(is_near(shines({1, 1, -1}, true), {20, 10, 5}));
}

TEST_CASE("texture transforms: an offset, a scale, and a turn of the image clockwise") {
  GltfFile moved;
  CHECK(is_near(at(picture_of(moved, seen_as_image(moved, transform({{"offset", {0.5, 0}}}))), .25, .25),
                green));
  GltfFile scaled;
  const Image half = picture_of(scaled, seen_as_image(scaled, transform({{"scale", {0.5, 0.5}}})));
  for (const double x : {.25, .5}) CHECK(is_near(at(half, x, .5), red));
  GltfFile turned;
  const Image turn =
      picture_of(turned, seen_as_image(turned, transform({{"rotation", std::numbers::pi / 2}})));
  CHECK(is_near(at(turn, .25, .25), blue));
  CHECK(is_near(at(turn, .75, .25), red));
  CHECK(is_near(at(turn, .25, .75), white));
  CHECK(is_near(at(turn, .75, .75), green));
}

TEST_CASE("images are repeated, mirrored or clamped, each way") {
  const auto row = [](int wrap_s, int wrap_t, bool down) {
    GltfFile file;
    const int sampler = file.add("samplers", {{"wrapS", wrap_s}, {"wrapT", wrap_t}});
    const Image image =
        picture_of(file, seen_as_image(file, transform({{"scale", {2, 2}}}), {{"sampler", sampler}}), 16);
    std::string seen;
    for (const double x : {.125, .375, .625, .875}) {
      const Vec3d color = down ? at(image, .125, x) : at(image, x, .125);
      seen += is_near(color, red) ? 'r' : is_near(color, green) ? 'g' : is_near(color, blue) ? 'b' : '?';
    }
    return seen;
  };
  constexpr int repeat = 10497, clamp = 33071, mirror = 33648;
  CHECK(row(repeat, repeat, false) == "rgrg");
  CHECK(row(clamp, clamp, false) == "rggg");
  CHECK(row(mirror, repeat, false) == "rggr");
  CHECK(row(mirror, repeat, true) == "rbrb");
  CHECK(row(repeat, mirror, true) == "rbbr");
  CHECK(row(mirror, mirror, false) == "rggr");
  CHECK(row(mirror, mirror, true) == "rbbr");
}

TEST_CASE("alpha: opaque, masked at its threshold, blended") {
  const std::string two_alphas = png_file(
      4, 8, 6, {std::string("\xff\xff\xff\xa0\xff\xff\xff\xa0\xff\xff\xff\x60\xff\xff\xff\x60", 16)});
  const auto sides = [&](const Json& mode) {
    GltfFile file;
    Json material = mode;
    material["extensions"]["KHR_materials_unlit"] = Json::object();
    material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = file.add_texture(two_alphas);
    const Image image = picture_of(file, material, 1024);
    Vec3d sides;
    for (int y = 0; y < side; ++y)
      sides = sides + Vec3d(image.at(4, y).x, image.at(11, y).x, 0) / double(side);
    return sides;
  };
  CHECK(is_near(sides({{"alphaMode", "OPAQUE"}}), {1, 1, 0}));
  CHECK(is_near(sides({{"alphaMode", "MASK"}}), {1, 0, 0}));
  CHECK(is_near(sides({{"alphaMode", "MASK"}, {"alphaCutoff", 0.3}}), {1, 1, 0}));
  CHECK(is_near(sides({{"alphaMode", "MASK"}, {"alphaCutoff", 0.7}}), {0, 0, 0}));
  // 16 pixels of 1024 samples: 6 standard deviations of a mean, a false alarm in 10^9, are 0.023.
  CHECK(is_near(sides({{"alphaMode", "BLEND"}}), {160 / 255., 96 / 255., 0}, 0.023));
}

TEST_CASE("lights shine with candela and lux, as far as their cones reach") {
  const auto lit = [](const Json& light, double height) {
    GltfFile file;
    file.add_node({{"mesh", file.add_square(file.add("materials", chalk))}});
    add_light(file, light, {{"translation", {0, 0, height}}});
    file.add_orthographic(1);
    return picture(file, 64);
  };
  const double reflected = 0.5 / std::numbers::pi;
  const Image sun = lit({{"type", "directional"}, {"color", {1, 0.5, 0}}, {"intensity", 3}}, 7);
  CHECK(is_near(mean(sun), Vec3d(3, 1.5, 0) * reflected));
  // Over the middle pixels: 10 / 2^2, less by the cosine and the distance a few hundredths away.
  const Image bulb = lit({{"type", "point"}, {"intensity", 10}}, 2);
  CHECK(at(bulb, .5, .5).x == Approx(2.5 * reflected).epsilon(0.02));
  // cos^3 / 4 = cos / d^2, d^2 = 4 + .875^2 + .875^2
  const double d2 = 4 + 2 * .9375 * .9375;
  CHECK(at(bulb, 0, 0).x == Approx(10 * reflected * 2 / std::pow(d2, 1.5)).epsilon(0.02));
  const Image spot = lit(
      {{"type", "spot"}, {"intensity", 10}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.3}}}}, 2);
  CHECK(at(spot, .5, .5).x == Approx(2.5 * reflected).epsilon(0.02));
  CHECK(at(spot, .1, .5) == black);  // atan(.8 / 2) > 0.3
}

TEST_CASE("colours of vertices multiply the base colour, linearly") {
  GltfFile file;
  Json primitive = file.square(file.add("materials", chalk));
  primitive["attributes"]["COLOR_0"] = file.add_accessor<std::uint8_t>(
      {{255, 0, 0}, {0, 0, 255}, {0, 0, 255}, {255, 0, 0}}, {{"normalized", true}});
  file.add_node({{"mesh", file.add_mesh(primitive)}});
  add_light(file, {{"type", "directional"}, {"intensity", 2 * std::numbers::pi}}, Json::object());
  file.add_orthographic(1);
  const Image image = picture(file, 64);
  CHECK(is_near(at(image, .25, .5), {0.75 - 1 / 32., 0, 0.25 + 1 / 32.}, 0.01));
  CHECK(is_near(at(image, .75, .5), {0.25 - 1 / 32., 0, 0.75 + 1 / 32.}, 0.01));
}

TEST_CASE("cameras show what their angle or height spans") {
  GltfFile file;
  file.add_node({{"mesh", file.add_square(file.add("materials", {{"emissiveFactor", {1, 1, 1}}}))}});
  const int camera = file.add(
      "cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 2 * std::atan(2. / 5)}, {"znear", 6}}}});
  file.add_node({{"camera", camera}, {"translation", {0, 0, 5}}});
  CHECK(is_near(mean(picture(file)), Vec3d(0.25)));  // the near plane cuts nothing off
  GltfFile flat;
  flat.add_node({{"mesh", flat.add_square(flat.add("materials", {{"emissiveFactor", {1, 1, 1}}}))}});
  flat.add_orthographic(4);
  CHECK(is_near(mean(picture(flat)), Vec3d(1 / 16.)));
}

TEST_CASE(
    "glass, thin or solid, gives back all of the light around it, a thin pane shows what is behind it") {
  const auto glass = [](double thickness, double tint) -> Json {
    return {{"pbrMetallicRoughness", {{"baseColorFactor", {tint, tint, tint, 1}}, {"roughnessFactor", 0}}},
            {"extensions",
             {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
              {"KHR_materials_volume", {{"thicknessFactor", thickness}}}}}};
  };
  for (const double thickness : {0., 1.}) {
    CAPTURE(thickness);
    GltfFile file;
    file.add_node({{"mesh", file.add_sphere(file.add("materials", glass(thickness, 1)))}});
    file.add_orthographic(1.2);
    // A path is in the glass for ever with a chance that roulette makes up for: the mean is exact, its noise
    // small.
    CHECK(is_near(mean(picture(file, 256, white)), white, 0.02));
  }
  // Seen straight on through a pane of 1.5: 1 - 2 * 0.04 / 1.04 of the lamp behind it, times the tint.
  GltfFile file;
  file.add_node(
      {{"mesh", file.add_square(file.add("materials", glass(0, 0.5)))}, {"translation", {0, 0, 1}}});
  Json lamp = chalk;  // black, so that it reflects nothing of the pane's own reflection
  lamp["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
  lamp["emissiveFactor"] = {1, 1, 1};
  file.add_node({{"mesh", file.add_square(file.add("materials", lamp))}});
  file.add_orthographic(1);
  // 256 pixels of 1024 samples: 6 standard deviations are 0.0059.
  CHECK(is_near(mean(picture(file, 1024)), Vec3d(0.5 * (1 - 0.08 / 1.04)), 0.0059));
}
