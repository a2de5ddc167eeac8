#include <catch2/catch.hpp>

#include <filesystem>
#include <string>

#include "castray/scene.h"

using namespace castray;

namespace {

Scene load_named(const std::string& name) {
  return load_scene(std::string(CASTRAY_ROOT) + "/scenes/" + name + ".json");
}

Vec3d corner(const Scene& scene, std::uint32_t triangle, std::size_t i) {
  return scene.to_world(Vec3d(scene.positions[scene.triangles[triangle][i]]));
}

/// Not of unit length.
Vec3d normal(const Scene& scene, std::uint32_t triangle) {
  const Vec3d a = corner(scene, triangle, 0);
  return cross(corner(scene, triangle, 1) - a, corner(scene, triangle, 2) - a);
}

}  // namespace

TEST_CASE("every scene of scenes/ loads, lies in [-1,1] and has light") {
  for (const auto& entry : std::filesystem::directory_iterator(std::string(CASTRAY_ROOT) + "/scenes")) {
    if (entry.path().extension() != ".json" || entry.path().stem().extension() == ".schema") continue;
    INFO(entry.path());
    const Scene scene = load_scene(entry.path());
    CHECK(!scene.triangles.empty());
    CHECK(!scene.lights.empty());
    CHECK(scene.warnings.empty());
    CHECK(scene.dropped_triangles == 0);
    for (const Vec3f& p : scene.positions)
      for (int i = 0; i < 3; ++i) CHECK(std::abs(p[i]) <= 1);
  }
}

TEST_CASE("the Cornell box is the published one") {
  const Scene scene = load_named("cornell_box");
  CHECK(scene.triangles.size() == 32);
  REQUIRE(scene.lights.size() == 2);
  CHECK(scene.width == 784);
  CHECK(scene.unit == 512);
  CHECK(scene.center == Vec3d{278, 274.4, 279.6});
  // In the double it was parsed in, up to the rounding of a float in scene space.
  CHECK(corner(scene, scene.lights[0], 0).x == Approx(343).epsilon(1e-6));
  for (std::uint32_t t : scene.lights) {
    CHECK(normal(scene, t).y < 0);
    CHECK(scene.material_of(t).ke == Vec3d{47.8348, 38.5664, 31.0808});
  }
  CHECK(scene.camera.forward == Vec3d{0, 0, 1});
  CHECK(scene.camera.right == Vec3d{-1, 0, 0});
  CHECK(scene.to_world(scene.camera.position).z == Approx(-800));
  REQUIRE(scene.render_defaults.size() == 1);
  CHECK(scene.render_defaults[0].name == "spp");
  CHECK(scene.render_defaults[0].value == "64");
  CHECK(scene.render_defaults[0].place.line == 6);
}

TEST_CASE("one OBJ with its MTL is the same Cornell box") {
  const Scene parts = load_named("cornell_box"), whole = load_named("cornell_obj");
  REQUIRE(whole.triangles.size() == parts.triangles.size());
  REQUIRE(whole.lights.size() == parts.lights.size());
  for (std::uint32_t t = 0; t < parts.triangles.size(); ++t) {
    CHECK(whole.material_of(t).kd == parts.material_of(t).kd);
    CHECK(whole.material_of(t).ke == parts.material_of(t).ke);
    for (std::size_t i = 0; i < 3; ++i) CHECK(corner(whole, t, i) == corner(parts, t, i));
  }
}
