#include <catch2/catch.hpp>

#include <fstream>
#include <string>

#include "castray/scene.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// A scene with a triangle of its own, and an object of two triangles: one of them emits.
Scene load_with(const std::string& geometry) {
  const TemporaryFolder folder;
  std::ofstream(folder / "floor.obj") << "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nf 1 3 2\n";
  std::ofstream(folder / "thing.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
  std::ofstream(folder / "lamp.obj") << "v 0 0 1\nv 1 0 1\nv 0 1 1\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  std::ofstream(folder / "places.txt") << "# two copies\n1 0 0 5  0 1 0 0  0 0 1 0\n\n"
                                          "-2 0 0 0  0 2 0 6  0 0 2 0 # mirrored\n";
  std::ofstream(folder / "s.json") << R"({ "materials": { "grey": { "type": "diffuse" },
    "glow": { "type": "diffuse", "ke": 1 } },)" +
                                          geometry + "}";
  return load_scene(folder / "s.json");
}

const std::string object = R"("objects": { "thing": [ { "obj": "thing.obj", "material": "grey" },
  { "obj": "lamp.obj", "material": "glow", "transform": [ { "translate": [0,0,1] } ] } ] },)";

void check_same(const Scene& a, const Scene& b) {
  CHECK(a.center == b.center);
  CHECK(a.unit == b.unit);
  CHECK(a.positions == b.positions);
  CHECK(a.triangles == b.triangles);
  CHECK(a.triangle_material == b.triangle_material);
  CHECK(a.normals == b.normals);
  CHECK(a.triangle_normals == b.triangle_normals);
  CHECK(a.uvs == b.uvs);
  CHECK(a.triangle_uvs == b.triangle_uvs);
  CHECK(a.lights == b.lights);
}

}  // namespace

TEST_CASE("instances are what meshes at their places are") {
  const std::string meshes = R"("meshes": [ { "obj": "floor.obj" })";
  const auto thing_at = [](const std::string& steps) {
    return R"(, { "obj": "thing.obj", "material": "grey", "transform": [)" + steps + R"(] },
      { "obj": "lamp.obj", "material": "glow", "transform": [ { "translate": [0,0,1] },)" +
           steps + "] }";
  };
  const Scene repeated =
      load_with(meshes + thing_at(R"({ "rotate": [0,0,1,90] }, { "scale": [1,-1,3] })") +
                thing_at(R"({ "translate": [5,0,0] }, { "scale": 2 })") +
                thing_at(R"({ "scale": [-2,2,2] }, { "translate": [0,6,0] }, { "scale": 2 })") + "]");
  REQUIRE(repeated.triangles.size() == 7);
  REQUIRE(repeated.lights.size() == 3);
  const std::string first =
      R"({ "object": "thing", "transform": [ { "rotate": [0,0,1,90] }, { "scale": [1,-1,3] } ] },)";
  const std::string rest = R"(, "transform": [ { "scale": 2 } ] } ])";
  check_same(load_with(object + R"("instances": [)" + first +
                       R"({ "object": "thing", "transforms": "places.txt")" + rest + "," + meshes + "]"),
             repeated);
  check_same(load_with(object + R"("instances": [)" + first +
                       R"({ "object": "thing", "transforms": [ [1,0,0,5, 0,1,0,0, 0,0,1,0],
                                                               [-2,0,0,0, 0,2,0,6, 0,0,2,0] ])" +
                       rest + "," + meshes + "]"),
             repeated);
}

TEST_CASE("a scene may be made of instances alone, and may leave an object out") {
  const Scene scene = load_with(object + R"("instances": [ { "object": "thing" } ])");
  CHECK(scene.triangles.size() == 2);
  CHECK(scene.warnings.empty());
  const Scene other = load_with(object + R"("meshes": [ { "obj": "floor.obj" } ])");
  CHECK(other.triangles.size() == 1);
  REQUIRE(other.warnings.size() == 1);
  CHECK(other.warnings[0].message == "object 'thing' has no instance");
  CHECK(other.warnings[0].harmless);
}
