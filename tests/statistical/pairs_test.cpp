#include <catch2/catch.hpp>

#include <cmath>

#include "castray_blocks.h"
#include "instanced.h"

using namespace castray;
using namespace castray::test;

// Surfaces that are another material on each side: the kernels against castRay in double precision, and
// castRay against what each side alone looks like. Each `check` has a false-alarm rate of 1e-4.

namespace {

/// Materials of a sheet's two sides, and the pair of them.
std::uint16_t add_pair(SceneSketch& sketch, const Material& front, const Material& back) {
  Material pair = front;
  pair.back = sketch.add_material(back);
  sketch.scene.materials.back().emits_backwards = back.emits();
  return sketch.add_material(pair);
}

/// A gutter over a floor, seen from above and from its side, between a lamp of which the back is red and
/// glows, a mirror and a dark sky. `dull`: all is diffuse.
Scene gutter(bool dull) {
  SceneSketch sketch;
  const Material red{.name = "red", .kd = {0.7, 0.2, 0.1}}, blue{.name = "blue", .kd = {0.1, 0.2, 0.8}};
  Material metal{.name = "metal", .type = MaterialType::conductor, .reflectance = {0.9, 0.7, 0.4}};
  metal.alpha = 0.3;
  Material coated{.name = "coated", .type = MaterialType::microfacet, .kd = {0.1, 0.6, 0.2}};
  coated.ks = Vec3d(0.2);
  coated.alpha = 0.1;
  const auto floor = sketch.add_material({.name = "floor", .kd = Vec3d(0.6)});
  const auto sheet = dull ? add_pair(sketch, red, blue) : add_pair(sketch, metal, coated);
  const auto lamp = add_pair(sketch, {.name = "lamp", .kd = Vec3d(0.2), .ke = {9, 8, 7}},
                             {.name = "glow", .kd = {0.7, 0.2, 0.1}, .ke = {6, 1, 3}});
  const auto wall = dull ? floor : add_pair(sketch, {.name = "mirror", .type = MaterialType::conductor}, red);
  sketch.add_quad({-1, -0.5f, 1}, {1, -0.5f, 1}, {1, -0.5f, -1}, {-1, -0.5f, -1}, floor);
  sketch.add_quad({-1, -0.5f, -0.9f}, {1, -0.5f, -0.9f}, {1, 1, -0.9f}, {-1, 1, -0.9f}, wall);
  sketch.add_quad({0.1f, 0.3f, 0.3f}, {0.1f, 0.3f, -0.3f}, {0.6f, 0.5f, -0.3f}, {0.6f, 0.5f, 0.3f}, lamp);
  constexpr int strips = 6;
  const auto edge = [](int i, float z) {
    const float angle = 3.14159265f * (1.f + static_cast<float>(i) / strips);
    return Vec3f(-0.3f + 0.5f * std::cos(angle), 0.1f + 0.5f * std::sin(angle), z);
  };
  for (int i = 0; i < strips; ++i)
    sketch.add_quad(edge(i, 0.5f), edge(i + 1, 0.5f), edge(i + 1, -0.5f), edge(i, -0.5f), sheet);
  sketch.scene.environment = {0.2, 0.25, 0.3};
  sketch.scene.camera = make_camera({0.6, 1, 2.2}, {0, 0, 0}, {0, 1, 0}, 40);
  return sketch.scene;
}

}  // namespace

TEST_CASE("kernels see each side of a surface as castRay does", "[statistical]") {
  for (const bool dull : {true, false}) {
    const Scene scene = gutter(dull);
    const Expected expected(scene);
    CAPTURE(dull);
    expected.check_each_kernel(scene);
    expected.check("plain", scene, plain(wavefront_options(8)));
    expected.check("instances, some mirrored", as_instances(scene, kinds_of_places()), wavefront_options(4));
    if (!dull) expected.check_with("light paths", scene, [](RenderOptions& o) { o.caustics = Switch::on; });
  }
}

/// A lamp between floor and ceiling: the front shines down, the back, through an image, up. `apart`: two
/// lamps back to back instead.
Scene lamp_between(bool apart) {
  SceneSketch sketch;
  const Material down{.name = "down", .kd = Vec3d(0.5), .ke = {9, 8, 7}};
  Material up{.name = "up", .kd = Vec3d(0.1), .ke = {2, 4, 16}};
  up.map(SurfaceParameter::ke).texture = 0;
  Texture image{.name = "halves", .width = 2, .height = 1};
  image.floats = {1, 1, 1, 0.25f, 0, 0};
  sketch.scene.textures = {image};
  sketch.scene.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  const auto dull = sketch.add_material({.name = "dull", .kd = Vec3d(0.6)});
  const auto add_lamp = [&](float y, bool facing_down, std::uint16_t material) {
    const Vec3f a{-.4f, y, -.4f}, b{-.4f, y, .4f}, c{.4f, y, .4f}, d{.4f, y, -.4f};
    facing_down ? sketch.add_quad(d, c, b, a, material) : sketch.add_quad(a, b, c, d, material);
    sketch.scene.triangle_uvs.push_back(facing_down ? Index3{3, 2, 1} : Index3{0, 1, 2});
    sketch.scene.triangle_uvs.push_back(facing_down ? Index3{3, 1, 0} : Index3{0, 2, 3});
  };
  if (apart) {
    add_lamp(0, true, sketch.add_material(down));
    add_lamp(1e-4f, false, sketch.add_material(up));
  } else {
    add_lamp(0, true, add_pair(sketch, down, up));
  }
  sketch.add_quad({-1, -.5f, 1}, {1, -.5f, 1}, {1, -.5f, -1}, {-1, -.5f, -1}, dull);
  sketch.add_quad({-1, .5f, -1}, {1, .5f, -1}, {1, .5f, 1}, {-1, .5f, 1}, dull);
  sketch.scene.triangle_uvs.resize(sketch.scene.triangles.size(),
                                   {Scene::no_index, Scene::no_index, Scene::no_index});
  sketch.scene.camera = make_camera({0, 0.1, 2.6}, {0, 0, 0}, {0, 1, 0}, 40);
  return sketch.scene;
}

TEST_CASE("a lamp of two sides is two lamps back to back", "[statistical]") {
  const Expected expected(lamp_between(true));
  const Scene pair = lamp_between(false);
  expected.check("castRay", pair, as_reference(wavefront_options(16, 100)));
  expected.check("shared", pair, wavefront_options(4));
  expected.check("plain", pair, plain(wavefront_options(8)));
  expected.check_with("MIS", pair, [](RenderOptions& o) { o.mis = Switch::on; });
}

TEST_CASE("a side that is not seen changes nothing, the other does", "[statistical]") {
  const auto square = [](const Vec3d& front, const Vec3d& back, double z) {
    SceneSketch sketch;
    const auto pair = add_pair(sketch, {.name = "front", .kd = front, .ke = back},
                               {.name = "back", .kd = back, .ke = 2.0 * front});
    sketch.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, pair);
    sketch.scene.environment = Vec3d(1);
    sketch.scene.camera = make_camera({0, 0, z}, {0, 0, 0}, {0, 1, 0}, 20);
    return sketch.scene;
  };
  const Vec3d front{0.75, 0.5, 0.25}, back{0.125, 0.25, 0.5};
  RenderOptions options = wavefront_options(8, 1, 1);
  options.rr = 1;
  for (const Way& way : every_way(options))
    for (const double z : {2., -2.}) {
      CAPTURE(way.name, z);
      const Image image = render(square(front, back, z), way.options).film.image();
      for (const Vec3f& pixel : image.pixels)
        for (int c = 0; c < 3; ++c)
          REQUIRE(pixel[c] == Approx(back[c] + (z > 0 ? front[c] : 2 * front[c])).epsilon(1e-5));
    }
}
