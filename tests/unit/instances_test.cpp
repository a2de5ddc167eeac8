#include <catch2/catch.hpp>

#include <fstream>
#include <map>
#include <random>
#include <string>

#include "castray/scene.h"
#include "geometry/bvh.h"
#include "geometry/instance_bvh.h"
#include "geometry/scene_bvh.h"
#include "instanced.h"
#include "integrators.h"
#include "stress_checks.h"
#include "temporary_folder.h"
#include "test_scenes.h"

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

void check_near(const Vec3d& found, const Vec3d& expected) {
  INFO(found.x << ' ' << found.y << ' ' << found.z);
  for (int i = 0; i < 3; ++i) CHECK(found[i] == Approx(expected[i]).margin(1e-6));
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

namespace {

const std::string kept_twice =
    R"("instancing": "keep", "instances": [ { "object": "thing", "transform": [ { "scale": 2 } ] },
        { "object": "thing", "transform": [ { "scale": [-1,1,1] }, { "translate": [-3,0,0] } ] } ])";

}  // namespace

TEST_CASE("instances that are kept share triangles, their lights do not") {
  const Scene scene = load_with(object + kept_twice + R"(, "meshes": [ { "obj": "floor.obj" } ])");
  CHECK(scene.own_triangles() == 3);  // the floor's and two lamps'
  CHECK(scene.lights.size() == 2);
  REQUIRE(scene.shared_meshes.size() == 1);
  CHECK(scene.shared_meshes[0].count == 1);
  CHECK(scene.instances.size() == 2);
  CHECK(scene.triangles.size() == 4);
  CHECK(scene.shown_triangles() == 5);
  const auto [low, high] = scene.bounds();
  check_near(scene.to_world(low), {-4, 0, -1});
  check_near(scene.to_world(high), {2, 2, 4});
  const SceneInstance& mirrored = scene.instances[1];
  const Vec3d corner(scene.positions[scene.triangles[3][1]]);  // (1,0,0) of the thing
  Vec3d moved;
  for (int i = 0; i < 3; ++i)
    moved[i] = dot(Vec3d(mirrored.rows[i]), corner) + double{mirrored.translation[i]};
  check_near(scene.to_world(moved), {-4, 0, 0});
}

TEST_CASE("an instance has the material that it names, and is a light if that emits") {
  const std::string instances =
      R"("instances": [ { "object": "thing" }, { "object": "thing", "material": "grey" },
         { "object": "thing", "material": "grey", "transform": [ { "scale": 2 } ] },
         { "object": "thing", "material": "glow", "transform": [ { "scale": 3 } ] } ])";
  const Scene expanded = load_with(object + instances);
  CHECK(expanded.triangles.size() == 8);
  CHECK(expanded.lights.size() == 3);
  const Scene kept = load_with(object + R"("instancing": "keep", )" + instances);
  CHECK(kept.lights.size() == 3);
  CHECK(kept.own_triangles() == 3);
  CHECK(kept.instances.size() == 3);
  std::vector<std::uint32_t> of_meshes;
  for (const SharedMesh& mesh : kept.shared_meshes) of_meshes.push_back(mesh.count);
  CHECK(std::ranges::count(of_meshes, 1u) == 1);  // without its lamp
  CHECK(std::ranges::count(of_meshes, 2u) == 1);  // all grey, held once
  CHECK_THROWS_WITH(load_with(object + R"("instances": [ { "object": "thing", "material": "gray" } ])"),
                    Catch::Contains("grey"));
}

TEST_CASE("trees leave objects without triangles out: lamps alone, and what rounding makes flat") {
  const Scene scene = load_with(R"("objects": {
      "lamp": [ { "obj": "lamp.obj", "material": "glow" } ], "none": [],
      "edge": [ { "obj": "thing.obj", "material": "grey", "transform": [ { "scale": [1,1e-60,1] } ] } ],
      "thing": [ { "obj": "thing.obj", "material": "grey" } ] },
    "instancing": "keep", "instances": [ { "object": "lamp" }, { "object": "none" }, { "object": "edge" },
      { "object": "thing" } ])");
  CHECK(scene.shown_triangles() == 2);
  CHECK(scene.instances.size() == 1);
  CHECK(InstanceBvh::build(scene, 1, BuildQuality::fast).stats().triangles == 2);
  CHECK(SceneBvh::build(scene, 1).stats().triangles == 2);
}

TEST_CASE("an instance that its transform skews too much becomes a mesh") {
  const Scene scene = load_with(object + R"("instancing": "keep", "instances": [ { "object": "thing",
      "transform": [ { "rotate": [0,0,1,45] }, { "scale": [1,1e3,1] }, { "rotate": [0,0,1,45] } ] } ])");
  CHECK(scene.instances.empty());
  CHECK(scene.expanded_instances == 1);
  CHECK(scene.own_triangles() == 2);
}

namespace {

/// A mesh as a scene, and the same as an instance.
struct Pair {
  Scene flat, instanced;
};

Pair pair_of(const FloatMesh& mesh, const Transform& place) {
  const Scene flat = scene_of(mesh.view());
  return {flat, as_instances(flat, {place})};
}

std::vector<Hit<float>> closest(const KernelApi& kernel, const InstanceBvh& tree, const RayArrays& rays) {
  std::vector<Hit<float>> hits(rays.size());
  rays.closest([&](const RayBatch& b) { kernel.instances_closest(tree.view(), b); }, 0, rays.size(),
               hits.data());
  return hits;
}

std::vector<std::uint8_t> occluded(const KernelApi& kernel, const InstanceBvh& tree, const RayArrays& rays) {
  std::vector<std::uint8_t> found(rays.size());
  rays.occluded([&](const ShadowBatch& b) { kernel.instances_occluded(tree.view(), b); }, 0, rays.size(),
                found.data());
  return found;
}

}  // namespace

TEST_CASE("no ray leaves a closed mesh that is an instance, through seams or elsewhere") {
  for (const ClosedShape& closed :
       {closed_icosphere(5), closed_sliver_sphere(10, 3), closed_torus_knot(60, 8)}) {
    const FloatMesh mesh = place(closed.shape, 0.5);
    const std::vector<Ray<float>> at_seams = rays_at_seams<float>(closed, mesh, 0.5, 0, 2000, 5);
    for (const Transform& at : kinds_of_places()) {
      const Pair scenes = pair_of(mesh, at);
      const InstanceBvh tree = InstanceBvh::build(scenes.instanced, 1, BuildQuality::fast);
      const SceneBvh binary = SceneBvh::build(scenes.instanced, 1);
      CAPTURE(closed.name);
      CHECK(std::ranges::all_of(at_seams, [&](const Ray<float>& ray) {
        return binary.closest(ray).found() && binary.occluded(ray);
      }));
      for (const KernelApi* kernel : available_kernels()) {
        CAPTURE(kernel->name);
        const RayArrays rays(at_seams);
        CHECK(std::ranges::count_if(closest(*kernel, tree, rays), &Hit<float>::found) ==
              std::ssize(at_seams));
        CHECK(std::ranges::count(occluded(*kernel, tree, rays), 1) == std::ssize(at_seams));
      }
    }
  }
}

namespace {

/// Whether it is what is expected of the ray, but for rounding, in distance, which is stretched where a ray
/// grazes.
template <class T>
bool is_near(const Ray<float>& ray, const Hit<T>& hit, const Hit<double>& expected) {
  const double apart = (double{hit.t} - expected.t) * length(Vec3d(ray.direction));
  return hit.found() == expected.found() && (!hit.found() || std::abs(apart) < 1e-5);
}

template <class T>
int far_hits(const SceneBvh& tree, const std::vector<Ray<float>>& rays, const Bvh& flat) {
  return static_cast<int>(std::ranges::count_if(rays, [&](const Ray<float>& ray) {
    const Ray<double> exact{Vec3d(ray.origin), Vec3d(ray.direction)};
    const Ray<T> traced{Vec3<T>(ray.origin), Vec3<T>(ray.direction)};
    return !is_near(ray, tree.closest(traced), flat.closest(exact)) ||
           tree.occluded(traced) != flat.occluded(exact);
  }));
}

}  // namespace

TEST_CASE("rays meet instances where they meet the flattened mesh in double") {
  const FloatMesh mesh = place(closed_torus_knot(200, 12).shape, 0.4);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(-1, 1);
  const auto point = [&] {
    const float x = coordinate(random), y = coordinate(random);
    return Vec3f{x, y, coordinate(random)};
  };
  std::vector<Ray<float>> rays(4000);
  for (Ray<float>& ray : rays) {
    ray.origin = point();
    ray.direction = point();
  }
  for (const Transform& at : kinds_of_places()) {
    const Pair scenes = pair_of(mesh, at);
    const Bvh flat = Bvh::build(mesh_of(scenes.flat), 1);
    const InstanceBvh tree = InstanceBvh::build(scenes.instanced, 1, BuildQuality::fast);
    const SceneBvh binary = SceneBvh::build(scenes.instanced, 1);
    CHECK(far_hits<float>(binary, rays, flat) <= 2);  // such rays may pass an outline on its other side
    CHECK(far_hits<double>(binary, rays, flat) <= 2);
    for (const KernelApi* kernel : available_kernels()) {
      CAPTURE(kernel->name);
      const auto hits = closest(*kernel, tree, RayArrays(rays));
      const auto blocked = occluded(*kernel, tree, RayArrays(rays));
      int found = 0, differ = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit<double> expected =
            flat.closest(Ray<double>{Vec3d(rays[i].origin), Vec3d(rays[i].direction)});
        CHECK(hits[i].found() == (blocked[i] == 1));
        found += hits[i].found();
        differ += !is_near(rays[i], hits[i], expected);
      }
      CHECK(found > 100);
      CHECK(differ <= 2);
    }
  }
}

TEST_CASE(
    "kernels of the same arithmetic find the same hits on instances, whatever the threads of the build") {
  const Scene flat = test::standard_scene("cornell_obj");
  const Scene scene = as_instances(flat, kinds_of_places());
  const RayArrays rays(rays_around(FloatMesh{flat.positions, flat.triangles}, 3000, 7));
  const InstanceBvh tree = InstanceBvh::build(scene, 1, BuildQuality::fast),
                    other = InstanceBvh::build(scene, 3, BuildQuality::best);
  // By has_fma: half of the rays meet vertices, where rounding decides.
  std::map<bool, std::vector<Hit<float>>> first;
  const auto same = [](const Hit<float>& a, const Hit<float>& b) {
    return a.triangle == b.triangle && a.instance == b.instance;
  };
  for (const KernelApi* kernel : available_kernels()) {
    CAPTURE(kernel->name);
    const auto hits = closest(*kernel, tree, rays);
    const auto& expected = first.try_emplace(test::has_fma(kernel->name), hits).first->second;
    CHECK(std::ranges::count_if(hits, &Hit<float>::found) > 500);
    CHECK(std::ranges::equal(hits, expected, same));
    CHECK(std::ranges::equal(closest(*kernel, other, rays), expected, same));
  }
}
