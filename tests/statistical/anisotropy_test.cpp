#include <catch2/catch.hpp>

#include <cmath>

#include "castray_blocks.h"
#include "core/warp.h"
#include "instanced.h"
#include "materials/texture.h"

using namespace castray;
using namespace castray::test;

// Metals whose lobes are not round: how they lie on a surface, the kernels against castRay in double
// precision. Each `check` has a false-alarm rate of 1e-4.

namespace {

/// Gives each quad texture coordinates in lengths along its first side and across, turned by `degrees`; those
/// of every second quad are mirrored.
void add_coordinates(Scene& scene, double degrees) {
  const double c = std::cos(degrees * pi<double> / 180), s = std::sin(degrees * pi<double> / 180);
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const std::uint32_t corner = scene.triangles[t][0];
    const Vec3d a(scene.positions[corner]);
    const auto side = [&](std::uint32_t k) { return Vec3d(scene.positions[corner + k]) - a; };
    const Vec3d x = normalize(side(1)), y = cross(normalize(cross(x, side(3))), x);
    const auto first = static_cast<std::uint32_t>(scene.uvs.size());
    for (const std::uint32_t p : scene.triangles[t]) {
      const Vec3d at = Vec3d(scene.positions[p]) - a;
      const double u = dot(at, x) * (t % 4 > 1 ? -1 : 1), v = dot(at, y);
      scene.uvs.push_back({static_cast<float>(c * u + s * v), static_cast<float>(c * v - s * u)});
    }
    scene.triangle_uvs.push_back({first, first + 1, first + 2});
  }
}

/// A brushed gutter with smooth normals before a wall, under a lamp and a dim sky. The metal lies along
/// texture coordinates that are turned by `uv_degrees`.
Scene gutter(const Material& metal, double uv_degrees) {
  SceneSketch sketch;
  const auto dull = sketch.add_material({.name = "dull", .kd = {0.6, 0.5, 0.4}});
  const auto brushed = sketch.add_material(metal);
  const auto lamp = sketch.add_material({.name = "lamp", .kd = Vec3d(0), .ke = {20, 18, 16}});
  constexpr int strips = 6;
  const auto normal = [](int i) {
    const float angle = 3.14159265f * (1.f + static_cast<float>(i) / strips);
    return Vec3f(-std::cos(angle), -std::sin(angle), 0);
  };
  const auto edge = [&](int i, float z) { return Vec3f(0, 0.1f, z) - 0.6f * normal(i); };
  Scene& scene = sketch.scene;
  const std::uint32_t none = Scene::no_index;
  for (int i = 0; i < strips; ++i) {
    sketch.add_quad(edge(i, 0.6f), edge(i + 1, 0.6f), edge(i + 1, -0.6f), edge(i, -0.6f), brushed);
    const auto n = static_cast<std::uint32_t>(i);
    scene.triangle_normals.insert(scene.triangle_normals.end(), {{n, n + 1, n + 1}, {n, n + 1, n}});
  }
  for (int i = 0; i <= strips; ++i) scene.normals.push_back(normal(i));
  sketch.add_quad({-1, -1, -0.9f}, {1, -1, -0.9f}, {1, 1, -0.9f}, {-1, 1, -0.9f}, dull);
  sketch.add_quad({-1, -0.55f, 1}, {1, -0.55f, 1}, {1, -0.55f, -1}, {-1, -0.55f, -1}, brushed);
  sketch.add_quad({0.1f, 0.9f, -0.2f}, {0.4f, 0.9f, -0.2f}, {0.4f, 0.9f, 0.1f}, {0.1f, 0.9f, 0.1f}, lamp);
  scene.triangle_normals.resize(scene.triangles.size(), {none, none, none});
  add_coordinates(scene, uv_degrees);
  scene.environment = {0.2, 0.25, 0.3};
  scene.camera = make_camera({0.6, 1, 2.2}, {0, 0, 0}, {0, 1, 0}, 40);
  return scene;
}

Material brushed(double alpha, double anisotropy, double degrees) {
  Material m{
      .name = "brushed", .type = MaterialType::conductor, .reflectance = {0.9, 0.7, 0.5}, .alpha = alpha};
  m.anisotropy = anisotropy;
  m.anisotropy_rotation = degrees;
  return m;
}

/// A blend with metal, by its index, under sheen and a coat.
Material layered(double alpha, double anisotropy, double degrees) {
  Material m = brushed(alpha, anisotropy, degrees);
  m.type = MaterialType::principled;
  m.kd = m.reflectance;
  m.ks = Vec3d(0.06);
  m.metallic = 0.7;
  m.sheen = 0.3;
  m.clearcoat = 0.8;
  m.clearcoat_roughness = 0.2;
  m.clearcoat_ior = 1.8;
  m.eta = {0.2, 0.5, 1.3}, m.k = {3.7, 2.7, 1.8};
  return m;
}

/// Puts an image of `pixels`, in a row, repeated every 0.7 of the texture coordinates, on a parameter.
void put_image(Scene& scene, SurfaceParameter parameter, const std::vector<Vec3f>& pixels) {
  Image image(static_cast<int>(pixels.size()), 1);
  image.pixels = pixels;
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (scene.materials[i].name == "brushed") {
      Material m = scene.materials[i];
      m.map(parameter).texture = static_cast<int>(scene.textures.size());
      m.map(parameter).scale = {1.4f, 1.4f};
      scene.materials[i] = m;
    }
  scene.textures.push_back(make_texture("lobes", image));
}

Vec3f grey(float x) { return {x, x, x}; }

/// What images hold of a direction at this angle from u towards v.
Vec3f towards(double degrees) {
  const double turn = degrees * pi<double> / 180;
  return {static_cast<float>((1 + std::cos(turn)) / 2), static_cast<float>((1 + std::sin(turn)) / 2), 0.5f};
}

/// The gutter of a metal whose lobes images of all three kinds change.
Scene gutter_by_images(const Material& metal) {
  Scene scene = gutter(metal, 0);
  put_image(scene, SurfaceParameter::anisotropy, {grey(1), grey(0.6f), grey(0)});
  put_image(scene, SurfaceParameter::anisotropy_rotation, {grey(0), grey(0.5f), grey(1)});
  put_image(scene, SurfaceParameter::anisotropy_direction, {towards(0), towards(80), towards(-30)});
  return scene;
}

}  // namespace

TEST_CASE("brushed metal is as castRay has it", "[statistical]") {
  const Scene scene = gutter(brushed(0.2, 0.8, 30), 0);
  const Expected expected(scene);
  check_same_bytes(scene, wavefront_options(2));
  for (const std::string& isa : arithmetics())
    expected.check_with(isa, scene, [&](RenderOptions& o) { o.isa = isa; });
  expected.check("plain", scene, plain(wavefront_options(8)));
  expected.check("instances, some mirrored", as_instances(scene, kinds_of_places()), wavefront_options(4));
}

TEST_CASE("layers with a brushed lobe are as castRay has them", "[statistical]") {
  const Scene scene = gutter(layered(0.2, 0.8, 30), 0);
  constexpr std::uint64_t seeds = 12;
  const Expected expected(scene, wavefront_options(8), seeds);
  expected.check("shared", scene, wavefront_options(8), seeds);
  RenderOptions others = plain(wavefront_options(8));
  others.isa = instruction_sets().front();
  expected.check("plain, " + others.isa, scene, others, seeds);
}

TEST_CASE("caustics of brushed metal by paths from lights are as castRay has them", "[statistical]") {
  const Scene scene = gutter(brushed(0.04, 0.8, -20), 0);
  const Expected expected(scene, wavefront_options(32));
  expected.check_with("from lights", scene, [](RenderOptions& o) { o.caustics = Switch::on; });
  expected.check_with("by chance", scene, [](RenderOptions& o) { o.caustics = Switch::off; });
}

TEST_CASE("lobes turn with the texture coordinates, and from u towards v", "[statistical]") {
  const Expected expected(gutter(brushed(0.2, 0.9, 0), 35));
  expected.check("turned", gutter(brushed(0.2, 0.9, 35), 0), as_reference(wavefront_options(16, 100)));
  const Scene other = gutter(brushed(0.2, 0.9, -35), 0);
  const BlockScores scores = block_scores(blocks_of(other, as_reference(wavefront_options(4, 100)), 12),
                                          expected.mean, expected.variance);
  CHECK(scores.largest > score_limit(scores.count, 1e-4));
}

TEST_CASE("lobes by images are as castRay has them", "[statistical]") {
  const Scene scene = gutter_by_images(brushed(0.2, 0.9, 90));
  const Expected expected(scene, wavefront_options(16), 12);
  check_same_bytes(scene, wavefront_options(2));
  expected.check("shared", scene, wavefront_options(4), 12);
  expected.check("instances, some mirrored", as_instances(scene, kinds_of_places()), wavefront_options(4),
                 12);
  const Scene layers = gutter_by_images(layered(0.2, 0.9, 90));
  Expected(layers, wavefront_options(8), 12).check("layers", layers, plain(wavefront_options(8)), 12);
}

// The same numbers by images that say the same everywhere: but for rounding the same picture.
TEST_CASE("images of lobes mean what their numbers mean") {
  const auto picture = [](const Scene& scene) {
    return blocks_of(scene, as_reference(wavefront_options(2)), 1)[0];
  };
  const auto difference = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      largest = std::max(largest, std::abs(a[i] - b[i]) / (a[i] + 0.01));
    return largest;
  };
  const std::vector<double> numbers = picture(gutter(brushed(0.2, 0.8, 50), 20));
  Scene by_values = gutter(brushed(0.2, 1.6, 100), 20);
  put_image(by_values, SurfaceParameter::anisotropy, {grey(0.5f)});
  put_image(by_values, SurfaceParameter::anisotropy_rotation, {grey(0.5f)});
  CHECK(difference(numbers, picture(by_values)) < 1e-3);
  Scene by_direction = gutter(brushed(0.2, 0.8, 20), 20);
  put_image(by_direction, SurfaceParameter::anisotropy_direction, {towards(30)});
  CHECK(difference(numbers, picture(by_direction)) < 1e-3);
  CHECK(difference(numbers, picture(gutter(brushed(0.2, 0.8, 20), 20))) > 0.05);
}
