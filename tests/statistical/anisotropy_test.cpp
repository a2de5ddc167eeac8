#include <catch2/catch.hpp>

#include <cmath>

#include "castray_blocks.h"
#include "core/warp.h"
#include "instanced.h"

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
