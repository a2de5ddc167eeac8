#include <catch2/catch.hpp>

#include <limits>

#include "integrators.h"
#include "materials/bent_normal.h"
#include "materials/texture.h"
#include "temporary_folder.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

Texture rgba_bytes() {
  Texture t{.name = "t", .width = 2, .height = 1, .channels = 4};
  t.bytes = {255, 0, 128, 255, 0, 51, 255, 102};
  return t;
}

Image gradient(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at(x, y) = {static_cast<float>(x) / static_cast<float>(width), static_cast<float>(y) / 8.f,
                        0.25f};
  return image;
}

/// A square in the plane z = 0, seen from +z, with (u,v) = (x,y); `mirrored`: u = -x.
Scene square(bool mirrored = false) {
  SceneSketch sketch;
  sketch.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, sketch.add_material({.name = "m"}));
  const float u = mirrored ? -1 : 1;
  sketch.scene.uvs = {{-u, -1}, {u, -1}, {u, 1}, {-u, 1}};
  sketch.scene.triangle_uvs = {{0, 1, 2}, {0, 2, 3}};
  sketch.scene.environment = {1, 1, 1};
  sketch.scene.camera = make_camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 30);
  return sketch.scene;
}

void put_texture(Scene& scene, SurfaceParameter parameter, const Image& image, float gain = 1) {
  scene.materials[0].map(parameter).texture = static_cast<int>(scene.textures.size());
  scene.materials[0].map(parameter).gain = gain;
  scene.textures.push_back(make_texture("t", image));
}

Image plain_image(const Vec3f& color) {
  Image image(2, 2);
  std::ranges::fill(image.pixels, color);
  return image;
}

}  // namespace

TEST_CASE("8-bit images stay bytes, others become floats, alpha is linear in both") {
  Raster raster;
  raster.width = 2;
  raster.height = 1;
  raster.channels = 4;
  raster.encoded = true;
  raster.bytes = {0, 10, 255, 51, 128, 51, 254, 102};
  const Texture srgb = make_texture("t", Raster(raster), ColorSpace::srgb);
  CHECK(srgb.bytes == raster.bytes);
  CHECK(srgb.floats.empty());
  CHECK(texel(srgb, 0)[1] == Approx(ToneCurve{}.decode(10 / 255.)));
  CHECK(texel(srgb, 0)[3] == Approx(0.2));
  CHECK(texel(make_texture("t", Raster(raster), ColorSpace::linear), 1)[0] == 128 / 255.f);
  raster.floats = {0, 0.3f, 1, 0.5f, 0, 0, 0, 1};
  raster.bytes = {};
  const Texture floats = make_texture("t", Raster(raster), ColorSpace::srgb);
  CHECK(floats.bytes.empty());
  CHECK(texel(floats, 0)[1] == Approx(ToneCurve{}.decode(0.3)));
  CHECK(texel(floats, 0)[3] == 0.5f);
}

TEST_CASE("each channel of a map is what it says, alpha is linear") {
  const Texture t = rgba_bytes();
  TextureMap map{.texture = 0};
  const double u = 0.75, v = 0.5;  // the second texel's centre
  const auto value = [&](Channel channel) {
    map.channel = channel;
    return map_color(t, map, u, v);
  };
  const auto srgb = [](int byte) { return ToneCurve{}.decode(byte / 255.); };
  CHECK(value(Channel::color).y == Approx(srgb(51)));
  CHECK(value(Channel::red).x == Approx(0).margin(1e-9));
  CHECK(value(Channel::blue).y == Approx(1));
  CHECK(value(Channel::alpha).z == Approx(0.4));
  CHECK(value(Channel::luminance).x == Approx(0.7152 * srgb(51) + 0.0722));
  map.channel = Channel::color;
  CHECK(map_number(t, map, u, v) == Approx(0.7152 * srgb(51) + 0.0722));
  map.base = 0.25f;
  map.gain = 0.5f;
  CHECK(map_color(t, map, u, v).z == Approx(0.75));
  CHECK(mean_color(t, map).x == Approx(0.5));
}

TEST_CASE("images repeat, or are clamped to their border") {
  const Texture t = make_texture("t", gradient(4, 4));
  TextureMap map{.texture = 0};
  CHECK(map_color(t, map, 1.375, 0.5).x == Approx(map_color(t, map, 0.375, 0.5).x));
  CHECK(map_color(t, map, -0.625, 2.5).x == Approx(map_color(t, map, 0.375, 0.5).x));
  map.clamp = true;
  CHECK(map_color(t, map, 5., 0.5).x == Approx(0.75));
  CHECK(map_color(t, map, -5., 0.5).x == 0);
  CHECK(map_color(t, map, 0.5, 9.).y == 0);
  CHECK(map_color(t, map, 0.5, -9.).y == Approx(3 / 8.));
  map.clamp = false;
  map.scale = {2, 1};
  map.offset = {0.25f, 0};
  CHECK(map_color(t, map, 0.25, 0.5).x == Approx(0.5 * (0.5 + 0.75)));
}

TEST_CASE("coordinates without a fraction, or none at all, stay inside the image") {
  const Texture t = make_texture("t", gradient(4, 4));
  for (const bool clamp : {false, true})
    for (const double x : {3e9, -3e9, 1e10, -1e30, 1e300, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
      TextureMap map{.texture = 0, .clamp = clamp};
      CHECK(is_finite(map_color(t, map, x, 0.2)));
      CHECK(is_finite(map_color(t, map, 0.2, x)));
      CHECK(is_finite(map_color(t, map, static_cast<float>(x), 0.2f)));
    }
}

TEST_CASE("huge coordinates and scales end nowhere but in the image, by every way of rendering") {
  for (const float huge : {3e9f, -1e10f, 1e30f, 3e38f})
    for (const bool clamp : {false, true}) {
      Scene scene = square();
      put_texture(scene, SurfaceParameter::kd, gradient(4, 4));
      scene.materials[0].map(SurfaceParameter::kd).clamp = clamp;
      scene.uvs[1] = {huge, 0.2f};
      scene.uvs[2] = {0.2f, -huge};
      Scene scaled = square();
      put_texture(scaled, SurfaceParameter::kd, gradient(4, 4));
      scaled.materials[0].map(SurfaceParameter::kd).scale = {huge, huge};
      RenderOptions options = wavefront_options(8, 2, 1);
      for (const Way& way : every_way(options)) {
        CAPTURE(huge, clamp, way.name);
        CHECK(render(scene, way.options).film.nonfinite_samples == 0);
        CHECK(render(scaled, way.options).film.nonfinite_samples == 0);
      }
    }
}

TEST_CASE("textures of one to four channels, bytes and floats, are the same to every kernel") {
  for (int channels = 1; channels <= 4; ++channels)
    for (const bool bytes : {true, false})
      for (const int side : {1, 3}) {
        Scene scene = square();
        Texture t{.name = "t",
                  .width = side,
                  .height = side,
                  .channels = channels,
                  .color_space = ColorSpace::linear};
        for (int i = 0; i < side * side * channels; ++i) {
          const int value = (37 * i + 50) % 256;
          if (bytes)
            t.bytes.push_back(static_cast<std::uint8_t>(value));
          else
            t.floats.push_back(static_cast<float>(value) / 255.f);
        }
        scene.textures = {t};
        scene.materials[0].kd = Vec3d(1);
        scene.materials[0].map(SurfaceParameter::kd).texture = 0;
        RenderOptions options = wavefront_options(16, 4, 1);
        options.max_depth = 2;  // the sky alone: radiance is the albedo
        options.jitter = false;
        Image expected;
        for (const Way& way : every_way(options)) {
          const Image image = render(scene, way.options).film.image();
          if (expected.pixels.empty()) expected = image;
          double worst = 0;
          for (std::size_t i = 0; i < image.pixels.size(); ++i)
            for (int c = 0; c < 3; ++c)
              worst = std::max(worst, std::abs(double{image.pixels[i][c]} - double{expected.pixels[i][c]}));
          CAPTURE(channels, bytes, side, way.name);
          CHECK(worst < 1e-5);
        }
      }
}

TEST_CASE("a normal map tilts towards growing u and v, also where the image is mirrored") {
  for (const bool mirrored : {false, true}) {
    Scene scene = square(mirrored);
    put_texture(scene, SurfaceParameter::normal, plain_image({0.5f + 0.3f, 0.5f, 0.5f + 0.4f}));
    const TrianglePlace<double> place{0, 0.3, 0.3};
    Vec3d n = bent_normal(scene, scene.materials[0], place, InPlace(), Vec3d(0, 0, 1));
    CHECK(n.x == Approx(mirrored ? -0.6 : 0.6));
    CHECK(n.y == Approx(0).margin(1e-7));
    CHECK(n.z == Approx(0.8));
    scene.materials[0].map(SurfaceParameter::normal).gain = 0;
    n = bent_normal(scene, scene.materials[0], place, InPlace(), Vec3d(0, 0, 1));
    CHECK(n.z == Approx(1));
    scene.textures[0] = make_texture("t", plain_image({0.5f, 0.5f + 0.3f, 0.5f + 0.4f}));
    scene.materials[0].map(SurfaceParameter::normal).gain = 1;
    n = bent_normal(scene, scene.materials[0], place, InPlace(), Vec3d(0, 0, 1));
    CHECK(n.y == Approx(0.6));
    CHECK(n.x == Approx(0).margin(1e-7));
  }
}

TEST_CASE("a bump map's normal is that of the surface it stands for") {
  for (const bool mirrored : {false, true}) {
    Scene scene = square(mirrored);
    scene.unit = 2;  // a scene of [-1,1] that is [-2,2] in the world
    put_texture(scene, SurfaceParameter::bump, gradient(8, 8), 0.6f);  // red grows by 1 over u of 1
    scene.materials[0].map(SurfaceParameter::bump).channel = Channel::red;
    const TrianglePlace<double> place{0, 0.3, 0.4};  // away from the image's edge
    const Vec3d n = bent_normal(scene, scene.materials[0], place, InPlace(), Vec3d(0, 0, 1));
    const Vec3d expected = normalize(Vec3d(mirrored ? 0.3 : -0.3, 0, 1));  // height 0.6 / unit 2 over x of 1
    CAPTURE(mirrored);
    for (int c = 0; c < 3; ++c) CHECK(n[c] == Approx(expected[c]).margin(1e-6));
  }
}

TEST_CASE("bent normals let no light through a closed wall, by any way of rendering") {
  SceneSketch sketch;
  const auto wall = sketch.add_material({.name = "wall", .kd = Vec3d(1)});
  sketch.add_cube(0.5, {}, true, wall);
  Scene scene = sketch.scene;
  scene.environment = {1, 1, 1};
  scene.camera = make_camera({0.1, 0.2, 0.3}, {-0.2, 0, -0.5}, {0, 1, 0}, 90);
  scene.uvs = {{0, 0}, {1, 0}, {0, 1}};
  scene.triangle_uvs.assign(scene.triangles.size(), {0, 1, 2});
  Image wild(8, 8);
  for (std::size_t i = 0; i < wild.pixels.size(); ++i)
    wild.pixels[i] = {static_cast<float>(i % 3) / 2, static_cast<float>(i % 5) / 4,
                      static_cast<float>(i % 2)};
  put_texture(scene, SurfaceParameter::normal, wild);
  put_texture(scene, SurfaceParameter::bump, wild, 5);
  for (const MaterialType type : {MaterialType::diffuse, MaterialType::microfacet, MaterialType::conductor}) {
    scene.materials[0].type = type;
    scene.materials[0].alpha = 0.5;
    scene.materials[0].ks = Vec3d(0.5);
    for (const Way& way : every_way(wavefront_options(16, 4, 1))) {
      const RenderResult result = render(scene, way.options);
      double brightest = 0;
      for (const Vec3f& p : result.film.image().pixels)
        brightest = std::max(brightest, double{max_component(p)});
      CAPTURE(static_cast<int>(type), way.name);
      CHECK(brightest == 0);
      CHECK(result.film.nonfinite_samples == 0);
    }
  }
}

TEST_CASE("coverage is looked up in its image") {
  Scene scene = square();
  scene.materials[0].coverage = 0.5;
  const TrianglePlace<double> place{0, 0.25, 0.5};
  CHECK(coverage_at(scene, place) == 0.5);
  put_texture(scene, SurfaceParameter::coverage, plain_image(Vec3f(0.5f)));
  CHECK(coverage_at(scene, place) == Approx(0.25));
}
