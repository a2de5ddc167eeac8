#include <catch2/catch.hpp>

#include <cmath>

#include "castray_blocks.h"
#include "lights/area_lights.h"
#include "materials/texture.h"

using namespace castray;
using namespace castray::test;

// Lamps of which an image says what they emit: points on them are chosen by it. Each `check` has a
// false-alarm rate of 1e-4.

namespace {

/// A lamp of pieces x pieces squares above a floor and a rough metal wall, dim but for a spot in one corner;
/// a mirror, where asked for.
Scene room_under_a_spot(bool two_sided, bool mirror, int pieces = 1) {
  SceneSketch sketch;
  Scene& scene = sketch.scene;
  // found by chance in a mirror, a brighter one would be too rare
  const Vec3f spot = mirror ? Vec3f{2, 1.5f, 1} : Vec3f{40, 30, 20};
  Image image(32, 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) image.at(x, y) = x / 4 == 5 && y / 4 == 2 ? spot : Vec3f(0.1f);
  Material lamp{.name = "lamp", .kd = Vec3d(0.3), .ke = Vec3d(1)};
  lamp.two_sided_emission = two_sided;
  lamp.map(SurfaceParameter::ke) = {.texture = 0, .gain = 1};
  scene.textures.push_back(make_texture("spot", image));
  Material metal{.name = "metal", .type = MaterialType::conductor, .alpha = mirror ? 0 : 0.15};
  const auto glowing = sketch.add_material(lamp), shiny = sketch.add_material(metal);
  const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.7)});
  for (int i = 0; i < pieces * pieces; ++i) {
    const auto corner = [&](int x, int z) {
      scene.uvs.push_back({static_cast<float>(i % pieces + x) / static_cast<float>(pieces),
                           static_cast<float>(i / pieces + z) / static_cast<float>(pieces)});
      return Vec3f(scene.uvs.back()[0] - .5f, .6f, scene.uvs.back()[1] - .5f);
    };
    const Vec3f a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
    sketch.add_quad(a, b, c, d, glowing);
  }
  scene.triangle_uvs = scene.triangles;
  sketch.add_quad({-1, -.5f, 1}, {1, -.5f, 1}, {1, -.5f, -1}, {-1, -.5f, -1}, white);
  sketch.add_quad({-1, -.5f, -.9f}, {1, -.5f, -.9f}, {1, 1, -.9f}, {-1, 1, -.9f}, shiny);
  sketch.add_quad({-1, .95f, -1}, {1, .95f, -1}, {1, .95f, 1}, {-1, .95f, 1}, white);
  scene.triangle_uvs.resize(scene.triangles.size(), {Scene::no_index, Scene::no_index, Scene::no_index});
  scene.camera = make_camera({0.4, 0.2, 2.4}, {0, 0.1, 0}, {0, 1, 0}, 40);
  return scene;
}

/// Calls `visit` with the cells of a grid over the unit square.
template <class Visit>
void for_each_of_grid(int n, Visit visit) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) visit((i + 0.5) / n, (j + 0.5) / n);
}

}  // namespace

TEST_CASE("points on a lamp with an image are chosen by what it emits, with the density that is told") {
  const Scene scene = room_under_a_spot(false, false);
  const AreaLights<double> lights(scene);
  constexpr int choices = 4096, along = 8;
  double in_spot = 0, area = 0, flux = 0, most = 0;
  for (int k = 0; k < choices; ++k)
    for_each_of_grid(along, [&](double x, double y) {
      const LightPoint<double> p = lights.sample((k + 0.5) / choices, {x, y});
      constexpr double weight = 1. / (choices * along * along);
      in_spot += weight * (p.radiance.x > 20);
      area += weight / p.pdf_area;
      flux += weight * p.radiance.x / p.pdf_area;
      most = std::max(most, p.radiance.x / p.pdf_area);
    });
  double expected = 0;  // by its texels, with edges that are soft over one of them
  for_each_of_grid(512, [&](double u, double v) {
    expected +=
        map_color(scene.textures[0], scene.materials[0].map(SurfaceParameter::ke), u, v).x / (512 * 512);
  });
  CHECK(area == Approx(1).epsilon(1e-3));
  CHECK(flux == Approx(expected).epsilon(1e-3));
  CHECK(in_spot > 0.6);  // of its 1/64 of the area: 0.72 of the light is brighter than half
  CHECK(most < 10);      // 40 where points are uniform; the rest is in cells at the edge of the spot
}

TEST_CASE("castRay sees a lamp with an image as quadrature does", "[statistical]") {
  // One point of the floor, by quadrature.
  Scene scene = room_under_a_spot(false, false);
  const Vec3d at{0.1, -0.5, 0.2};
  Camera parallel;
  parallel.projection = Projection::orthographic;
  parallel.half_height = 1e-5;
  scene.camera = make_camera({0.1, 0, 0.2}, at, {0, 0, 1}, 40, parallel);
  Vec3d irradiance;
  for_each_of_grid(512, [&](double u, double v) {
    const Vec3d to = Vec3d{u - 0.5, 0.6, v - 0.5} - at;
    irradiance += map_color(scene.textures[0], scene.materials[0].map(SurfaceParameter::ke), u, v) *
                  (to.y * to.y / (dot(to, to) * dot(to, to)) / (512 * 512));
  });
  for (const Switch mis : {Switch::on, Switch::off}) {
    RenderOptions options = as_reference(wavefront_options(8, 256, 1));
    options.max_depth = 2;
    options.mis = mis;
    const Image image = render(scene, options).film.image();
    Vec3d sum, squares;
    for (const Vec3f& p : image.pixels) sum += Vec3d(p), squares += Vec3d(p) * Vec3d(p);
    const double n = static_cast<double>(image.pixels.size());
    for (int c = 0; c < 3; ++c) {
      const double mean = sum[c] / n, error = std::sqrt((squares[c] / n - mean * mean) / (n - 1));
      CAPTURE(c, mean, error);
      CHECK(error < 0.02 * mean);
      CHECK(std::abs(mean - 0.7 / pi<double> * irradiance[c]) < 4.6 * error);  // 1e-5 of 64 pixels' t
    }
  }
}

TEST_CASE("kernels sample lamps with images as castRay does", "[statistical]") {
  const Scene scene = room_under_a_spot(false, false);
  const Expected expected(scene);
  check_same_bytes(scene, wavefront_options(2));
  for (const std::string& isa : arithmetics())
    for (const Switch mis : {Switch::on, Switch::off})
      expected.check_with(isa, scene, [&](RenderOptions& o) { o.isa = isa, o.mis = mis; });
  expected.check("plain", scene, plain(wavefront_options(8)));
  expected.check_with("lights by area", scene, [](RenderOptions& o) { o.lights = LightSampling::area; });
  const Scene pieces = room_under_a_spot(false, false, 50);  // too many to be cut further
  Expected(pieces).check("pieces", pieces, wavefront_options(4));
  const Scene two_sided = room_under_a_spot(true, false);
  Expected(two_sided).check("two-sided", two_sided, wavefront_options(4));
  const Scene mirror = room_under_a_spot(false, true);
  Expected(mirror).check_with("light paths", mirror, [](RenderOptions& o) { o.caustics = Switch::on; });
}
