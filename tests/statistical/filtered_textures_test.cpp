#include <catch2/catch.hpp>

#include <random>

#include "castray_blocks.h"
#include "instanced.h"
#include "materials/texture.h"
#include "scene/transform.h"

using namespace castray;
using namespace castray::test;

// Images read over what pixels see: their means are those of points, by every way of rendering; and what is
// gained. Each `check` has a false-alarm rate of 1e-4.

namespace {

/// Every texel another colour.
Texture speckles(int size) {
  std::mt19937 random(1);
  Image image(size, size);
  for (Vec3f& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(random() % 256) / 255.f;
  return make_texture("speckles", image);
}

/// A floor to the horizon under a sky of one colour, seen at a slant; `size` texels of its image are two
/// units wide.
Scene floor_with(TextureFilter filter, int size = 16) {
  SceneSketch sketch;
  sketch.add_quad({-60, 0, 2}, {60, 0, 2}, {60, 0, -118}, {-60, 0, -118}, sketch.add_material({.name = "m"}));
  Scene& scene = sketch.scene;
  scene.uvs = {{0, 0}, {60, 0}, {60, 60}, {0, 60}};
  scene.triangle_uvs = {{0, 1, 2}, {0, 2, 3}};
  scene.environment = {1, 0.8, 0.5};
  scene.camera = make_camera({0, 1.5, 5}, {3, 0, -4}, {0.2, 1, 0}, 40);
  scene.textures.push_back(speckles(size));
  scene.materials[0].kd = Vec3d(1);
  scene.materials[0].map(SurfaceParameter::kd) = {.texture = 0, .filter = filter};
  return scene;
}

/// The floor's material and camera with changes, read by points and over pixels.
void check_filtered(const std::string& what, const std::function<void(Scene&)>& change) {
  Scene by_points = floor_with(TextureFilter::none), filtered = floor_with(TextureFilter::pixel);
  change(by_points), change(filtered);
  const Expected expected(by_points);
  expected.check(what + ", castRay", filtered, as_reference(wavefront_options(4)));
  expected.check(what + ", shared", filtered, wavefront_options(4));
  expected.check(what + ", plain", filtered, plain(wavefront_options(4)));
}

void move_map(Material& m, SurfaceParameter to) {
  m.map(to) = m.map(SurfaceParameter::kd);
  m.map(SurfaceParameter::kd) = {};
}

double squared_error(const Image& image, const Image& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    const Vec3d d = Vec3d(image.pixels[i]) - Vec3d(truth.pixels[i]);
    sum += dot(d, d);
  }
  return sum;
}

}  // namespace

TEST_CASE("the mean over a pixel is that of its points", "[statistical]") {
  check_filtered("diffuse", [](Scene&) {});
  check_filtered("metal", [](Scene& s) {
    s.materials[0].type = MaterialType::conductor;
    s.materials[0].alpha = 0.3;
    s.materials[0].reflectance = Vec3d(1);
    move_map(s.materials[0], SurfaceParameter::reflectance);
  });
  check_filtered("one channel, turned round", [](Scene& s) {
    TextureMap& map = s.materials[0].map(SurfaceParameter::kd);
    map.channel = Channel::green;
    map.scale = {-1.5f, 0.7f};
    map.base = 0.8f;
    map.gain = -0.5f;
  });
  check_filtered("clamped", [](Scene& s) {
    TextureMap& map = s.materials[0].map(SurfaceParameter::kd);
    map.clamp = true;
    map.scale = {0.2f, 0.2f};
  });
}

TEST_CASE("the mean over a pixel is that of its points by every camera", "[statistical]") {
  check_filtered("lens", [](Scene& s) { s.camera.lens = {.radius = 0.2, .focus_distance = 6, .blades = 5}; });
  check_filtered("orthographic", [](Scene& s) {
    s.camera.projection = Projection::orthographic;
    s.camera.half_height = 3;
  });
  check_filtered("panorama", [](Scene& s) { s.camera.projection = Projection::panorama; });
}

TEST_CASE("the mean over a pixel is that of its points on instances", "[statistical]") {
  const Expected expected(floor_with(TextureFilter::none));
  for (const Transform& place : kinds_of_places()) {
    const Scene scene = as_instances(floor_with(TextureFilter::pixel), {place});
    expected.check("castRay", scene, as_reference(wavefront_options(1)));
    expected.check("wavefront", scene, wavefront_options(4));
  }
}

TEST_CASE("each kernel reads pixels as castRay does", "[statistical]") {
  const Scene scene = floor_with(TextureFilter::pixel);
  const Image expected = image_of(render(scene, as_reference(wavefront_options(1))).film);
  for (const std::string& isa : instruction_sets()) {
    RenderOptions options = plain(wavefront_options(1));
    options.sampler = SamplerKind::independent;
    options.isa = isa;
    CAPTURE(isa);
    // a rounding error may take a probe to the other side of its pixel
    CHECK(squared_error(image_of(render(scene, options).film), expected) < 1e-3 * side * side);
  }
}

TEST_CASE("where texels are larger than pixels, points are read", "[statistical]") {
  const auto film = [](TextureFilter filter) {
    Scene scene = floor_with(filter, 2);
    scene.camera = make_camera({0, 1, 0}, {0, 0, -0.01}, {0, 1, 0}, 20);
    return image_of(render(scene, wavefront_options(4)).film).pixels;
  };
  CHECK(film(TextureFilter::pixel) == film(TextureFilter::none));
}

TEST_CASE("one sample a pixel of fine detail has a tenth of the error", "[statistical]") {
  const auto image_by = [](TextureFilter filter, std::uint64_t spp) {
    Scene scene = floor_with(filter, 64);
    scene.camera = make_camera({0, 1.5, 5}, {0, 0, 2}, {0, 1, 0}, 40);
    return image_of(render(scene, wavefront_options(spp)).film);
  };
  const Image truth = image_by(TextureFilter::none, 4096);
  const double points = squared_error(image_by(TextureFilter::none, 1), truth),
               pixels = squared_error(image_by(TextureFilter::pixel, 1), truth);
  CAPTURE(points, pixels);
  CHECK(pixels < 0.1 * points);
}
