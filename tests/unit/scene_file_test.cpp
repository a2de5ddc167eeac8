#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "castray/image.h"
#include "castray/scene.h"
#include "plan/film_key.h"
#include "scene/material_writer.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// A scene whose mesh is the triangle (0,0,0) (1,0,0) (0,1,0), facing +z, moved by `transform`.
Scene load_moved(const std::string& transform) {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1/1 2/2/1 3/3/1\n";
  std::ofstream(folder / "s.json") << R"({ "meshes": [ { "obj": "t.obj", "transform": [)" + transform +
                                          "] } ] }";
  return load_scene(folder / "s.json");
}

Scene load_text(const std::string& json) {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(folder / "s.json") << json;
  return load_scene(folder / "s.json");
}

Vec3d corner(const Scene& scene, std::size_t i) {
  return scene.to_world(Vec3d(scene.positions[scene.triangles[0][i]]));
}

Vec3d normal(const Scene& scene) {
  return normalize(cross(corner(scene, 1) - corner(scene, 0), corner(scene, 2) - corner(scene, 0)));
}

void check_near(const Vec3d& found, const Vec3d& expected) {
  INFO(found.x << ' ' << found.y << ' ' << found.z);
  for (int i = 0; i < 3; ++i) CHECK(found[i] == Approx(expected[i]).margin(1e-6));
}

}  // namespace

TEST_CASE("transform steps apply in order") {
  const Scene scene =
      load_moved(R"({ "scale": [2, 3, 4] }, { "rotate": [0, 0, 1, 90] }, { "translate": [10, 20, 30] })");
  check_near(corner(scene, 0), {10, 20, 30});
  check_near(corner(scene, 1), {10, 22, 30});
  check_near(corner(scene, 2), {7, 20, 30});
  check_near(normal(scene), {0, 0, 1});
  const Scene other =
      load_moved(R"({ "translate": [10, 20, 30] }, { "scale": 2 }, { "rotate": [0, 5, 0, -90] })");
  check_near(corner(other, 0), {-60, 40, 20});
  check_near(corner(other, 1), {-60, 40, 22});
  check_near(normal(other), {-1, 0, 0});
}

TEST_CASE("rotations about any axis keep lengths, turn by the angle, and quarter turns are exact") {
  const Scene scene = load_moved(R"({ "rotate": [1, 1, 1, 120] })");  // x -> y -> z -> x
  check_near(corner(scene, 1), {0, 1, 0});
  check_near(corner(scene, 2), {0, 0, 1});
  CHECK(corner(load_moved(R"({ "rotate": [0, 0, 1, 450] })"), 1) == Vec3d{0, 1, 0});
}

TEST_CASE("a mirroring transform keeps the outward side outward") {
  for (const char* mirror : {R"({ "scale": [-1, 1, 1] })", R"({ "scale": [1, -1, 1] })"}) {
    const Scene scene = load_moved(mirror);
    check_near(normal(scene), {0, 0, 1});
    check_near(Vec3d(scene.normals[scene.triangle_normals[0][0]]), {0, 0, 1});
  }
  // The triangle seen in a mirror at z = 0 faces the other way, as its mirror image does.
  const Scene scene = load_moved(R"({ "scale": [1, 1, -1] })");
  check_near(normal(scene), {0, 0, -1});
  check_near(Vec3d(scene.normals[scene.triangle_normals[0][0]]), {0, 0, -1});
  for (std::size_t i = 0; i < 3; ++i) {
    const auto uv = scene.uvs[scene.triangle_uvs[0][i]];
    check_near(corner(scene, i), {uv[0], uv[1], 0});
  }
}

TEST_CASE("shading normals follow a stretched surface") {
  const Scene scene = load_moved(R"({ "rotate": [0, 1, 0, 45] }, { "scale": [1, 1, 3] })");
  check_near(Vec3d(scene.normals[scene.triangle_normals[0][0]]), normal(scene));
}

TEST_CASE("a scene file says what is in the scene") {
  const Scene scene = load_text(R"({
    // comments and a trailing one
    "image": { "width": 10, "height": 20 },
    "render": { "spp": 16, "jitter": false, "crop": [0, 1, 2, 3], "rr": "auto", "epsilon": 1e-5 },
    "materials": { "m": { "type": "conductor", "roughness": 0.5, "reflectance": [1, 0.5, 0], "ke": [1, 2, 3],
                          "two_sided_emission": true } }, /* here */
    "meshes": [ { "obj": "t.obj", "material": "m", "normals": "face" } ],
    "environment": { "radiance": [0.5, 1, 2] }
  } // there)");
  CHECK(scene.width == 10);
  CHECK(scene.height == 20);
  CHECK(scene.environment == Vec3d{0.5, 1, 2});
  REQUIRE(scene.materials.size() == 1);
  const Material& material = scene.materials[0];
  CHECK(material.type == MaterialType::conductor);
  CHECK(material.alpha == 0.25);
  CHECK(material.reflectance == Vec3d{1, 0.5, 0});
  CHECK(material.ke == Vec3d{1, 2, 3});
  CHECK(material.two_sided_emission);
  std::string flags;
  for (const RenderDefault& flag : scene.render_defaults) flags += flag.name + "=" + flag.value + " ";
  CHECK(flags == "spp=16 jitter=off crop=0,1,2,3 rr=auto epsilon=1e-5 ");
  CHECK(scene.render_defaults[1].place.line == 4);
  CHECK(scene.render_defaults[1].place.column == 28);
}

TEST_CASE("a scene in which nothing emits has a white sky, unless its file says what is around it") {
  const Scene bare = load_text(R"({ "meshes": [ { "obj": "t.obj" } ] })");
  CHECK(bare.default_environment);
  CHECK(bare.environment == Vec3d{1, 1, 1});
  CHECK(bare.warnings.empty());
  const Scene red =
      load_text(R"({ "meshes": [ { "obj": "t.obj" } ], "environment": { "radiance": [1, 0, 0] } })");
  CHECK(!red.default_environment);
  CHECK(red.environment == Vec3d{1, 0, 0});
  CHECK(load_text(R"({ "meshes": [ { "obj": "t.obj" } ], "environment": { "radiance": [0, 0, 0] } })")
            .environment == Vec3d{0, 0, 0});
  const Scene lit = load_text(R"({ "materials": { "a": { "type": "diffuse", "ke": [1, 1, 1] } },
                                   "meshes": [ { "obj": "t.obj", "material": "a" } ] })");
  CHECK(!lit.default_environment);
  CHECK(lit.environment == Vec3d{0, 0, 0});
}

TEST_CASE("a camera is right-handed and orthonormal") {
  const Camera camera = make_camera({1, 2, 3}, {4, -2, 9}, {0, 2, 1}, 90);
  check_near(cross(camera.forward, camera.up), camera.right);
  CHECK(length(camera.right) == Approx(1).epsilon(1e-15));
  CHECK(dot(camera.up, camera.forward) == Approx(0).margin(1e-15));
  CHECK(camera.tan_half_fov == Approx(1));
  check_near(camera.direction(5, 5, 10, 10), camera.forward);
  check_near(camera.direction(10, 5, 10, 10), camera.forward + camera.right);
  // Also where squares would vanish, and as far away as can be.
  check_near(make_camera({0, 0, 0}, {1e100, 0, 0}, {0, 1e-200, 0}, 40).up, {0, 1, 0});
}

TEST_CASE("parameters of materials may be images") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  write_image(folder / "t.png", Image(2, 2));
  std::ofstream(folder / "s.json") << R"({ "materials": { "m": { "type": "principled",
    "kd": { "image": "t.png", "factor": [0.5, 0.25, 1], "scale": [2, 3], "offset": [0.5, 0], "clamp": true },
    "ks": { "image": "t.png", "filter": "pixel" }, "roughness": { "image": "t.png", "channel": "green", "factor": 0.5 },
    "metallic": 0.5, "normal_map": { "image": "t.png", "gain": 0.5 },
    "coverage": { "image": "t.png", "base": 1, "gain": -1 } } },
    "meshes": [ { "obj": "t.obj", "material": "m" } ] })";
  const Scene scene = load_scene(folder / "s.json");
  const Material& m = scene.material_of(0);
  CHECK(m.kd == Vec3d(0.5, 0.25, 1));
  CHECK(m.ks == Vec3d(1));
  CHECK(m.alpha == 0.25);
  CHECK(m.metallic == 0.5);
  REQUIRE(scene.textures.size() == 2);  // the file as colours and as data
  const TextureMap& kd = m.map(SurfaceParameter::kd);
  CHECK(scene.textures[static_cast<std::size_t>(kd.texture)].color_space == ColorSpace::srgb);
  CHECK(scene.textures[static_cast<std::size_t>(kd.texture)].bytes.size() == 12);
  CHECK(kd.scale == std::array<float, 2>{2, 3});
  CHECK(kd.offset == std::array<float, 2>{0.5f, 0});
  CHECK(kd.clamp);
  CHECK(kd.filter == TextureFilter::none);
  CHECK(m.map(SurfaceParameter::ks).filter == TextureFilter::pixel);
  const auto written = material_json(m, scene, [](int) { return std::string("t.png"); });
  CHECK(written["ks"].dump() == R"({"image":"t.png","filter":"pixel"})");
  CHECK_FALSE(written["kd"].contains("filter"));
  const TextureMap& roughness = m.map(SurfaceParameter::roughness);
  CHECK(roughness.channel == Channel::green);
  CHECK(scene.textures[static_cast<std::size_t>(roughness.texture)].color_space == ColorSpace::linear);
  CHECK(m.map(SurfaceParameter::normal).gain == 0.5f);
  CHECK(m.map(SurfaceParameter::coverage).base == 1);
  CHECK_FALSE(m.map(SurfaceParameter::alpha).used());
}

TEST_CASE("a material may be another one on each side") {
  const Scene scene = load_text(R"({ "materials": {
      "sheet": { "type": "two_sided", "front": "paint", "back": { "type": "conductor", "alpha": 0.2 } },
      "paint": { "type": "diffuse", "kd": 0.25, "ke": 3 },
      "turned": { "type": "two_sided", "front": { "type": "diffuse", "kd": 0.125 }, "back": "plain" },
      "plain": { "type": "diffuse", "kd": 0.5 } },
    "meshes": [ { "obj": "t.obj", "material": "sheet" }, { "obj": "t.obj", "material": "turned" } ] })");
  const auto side = [&](std::uint32_t triangle, bool front) {
    return scene.materials[scene.on_side(scene.triangle_material[triangle], front)];
  };
  CHECK(scene.material_of(0).name == "sheet");
  CHECK(side(0, true).kd == Vec3d(0.25));
  CHECK(side(0, true).ke == Vec3d(3));
  CHECK(side(0, false).type == MaterialType::conductor);
  CHECK(side(0, false).alpha == 0.2);
  CHECK(side(0, false).name == "sheet (back)");
  CHECK_FALSE(side(0, false).emits());
  CHECK(side(1, true).kd == Vec3d(0.125));
  CHECK(side(1, false).name == "plain");
  CHECK(scene.lights == std::vector<std::uint32_t>{0});
  const Scene other = load_text(R"({ "materials": {
      "a": { "type": "two_sided", "front": "b", "back": "b" }, "b": { "type": "diffuse" } },
    "meshes": [ { "obj": "t.obj", "material": "a" } ] })");
  CHECK(scene_hash(other) != scene_hash(load_text(R"({ "materials": {
      "a": { "type": "diffuse" }, "b": { "type": "diffuse" } },
    "meshes": [ { "obj": "t.obj", "material": "a" } ] })")));
}

TEST_CASE("each side of a material may emit") {
  const Scene scene = load_text(R"({ "materials": {
      "lamp": { "type": "diffuse", "ke": 3 },
      "turned": { "type": "two_sided", "front": { "type": "diffuse" }, "back": "lamp" },
      "both": { "type": "two_sided", "front": "lamp", "back": { "type": "diffuse", "ke": 2 } } },
    "meshes": [ { "obj": "t.obj", "material": "lamp" }, { "obj": "t.obj", "material": "turned" },
                { "obj": "t.obj", "material": "both" } ] })");
  CHECK(scene.lights == std::vector<std::uint32_t>{0, 1, 2});
  const auto emitted = [&](std::uint32_t triangle, bool front) {
    const std::uint16_t material = scene.triangle_material[triangle];
    return scene.emits_on(material, front) ? scene.materials[scene.on_side(material, front)].ke.x : 0;
  };
  CHECK(emitted(0, true) == 3);
  CHECK(emitted(0, false) == 0);
  CHECK(emitted(1, true) == 0);
  CHECK(emitted(1, false) == 3);
  CHECK(emitted(2, true) == 3);
  CHECK(emitted(2, false) == 2);
}

TEST_CASE("materials are written as they are read") {
  for (const std::string keys :
       {R"("type": "conductor", "reflectance": { "eta": [0.2, 0.9, 2.5], "k": [3.4, 1.5, 0] }, "alpha": 0.3)",
        R"("type": "conductor", "reflectance": "gold", "roughness": 0.5, "multiple_scattering": true)",
        R"("type": "dielectric", "ior": 1.3, "absorption": { "color": [0.3, 0.6, 1], "distance": 0.7 })"}) {
    const auto read = [](const std::string& material) {
      return load_text(R"({ "materials": { "m": )" + material +
                       R"( }, "meshes": [ { "obj": "t.obj", "material": "m" } ] })");
    };
    const Scene scene = read("{" + keys + "}");
    const Material& m = scene.materials[0];
    const std::string written = material_json(m, scene, [](int) { return std::string(); }).dump();
    const Material again = read(written).materials[0];
    CAPTURE(written);
    CHECK(again.type == m.type);
    CHECK(again.alpha == m.alpha);
    CHECK(again.ior == m.ior);
    CHECK(again.eta == m.eta);
    CHECK(again.k == m.k);
    CHECK(again.reflectance.y == Approx(m.reflectance.y));
    CHECK(again.absorption == m.absorption);
    CHECK(again.multiple_scattering == m.multiple_scattering);
  }
}

TEST_CASE("a number stands for a grey, a metal's name for what it reflects straight on") {
  const auto material = [](const std::string& keys) {
    return load_text(
        R"({ "materials": { "m": { )" + keys +
        R"( } }, "meshes": [ { "obj": "t.obj", "material": "m" } ], "environment": { "radiance": 2 } })");
  };
  check_near(material(R"("type": "diffuse", "kd": 0.25)").materials[0].kd, Vec3d(0.25));
  check_near(material(R"("type": "diffuse", "ke": 7)").materials[0].ke, Vec3d(7));
  CHECK(material(R"("type": "diffuse")").environment == Vec3d(2));
  // Aluminium and silver reflect evenly; gold and copper keep red; iron and chromium half of all.
  const auto metal = [&](const std::string& name) {
    return material(R"("type": "conductor", "reflectance": ")" + name + '"').materials[0].reflectance;
  };
  CHECK(metal("gold").x > metal("gold").y + 0.2);
  CHECK(metal("gold").y > metal("gold").z + 0.3);
  CHECK(metal("copper").x > metal("copper").y + 0.2);
  for (const std::string name : {"silver", "aluminium", "iron", "chromium"}) {
    const Vec3d color = metal(name);
    CHECK(max_component(color) - std::min({color.x, color.y, color.z}) < 0.04);
  }
  CHECK(metal("silver").y > 0.95);
  CHECK(metal("aluminium").y == Approx(0.92).margin(0.01));
  CHECK(metal("iron").y == Approx(0.52).margin(0.02));
  check_near(material(R"("type": "principled", "kd": "gold", "metallic": 1)").materials[0].kd, metal("gold"));
  // ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2)
  const std::string index = R"({ "eta": [1, 2, 0.5], "k": [2, 0, 1] })";
  const Vec3d by_hand(4. / 8, 1. / 9, 1.25 / 3.25);
  check_near(material(R"("type": "conductor", "reflectance": )" + index).materials[0].reflectance, by_hand);
  check_near(material(R"("type": "principled", "ks": )" + index).materials[0].ks, by_hand);
  CHECK_FALSE(material(R"("type": "principled", "ks": )" + index).materials[0].has_index());
  // A conductor follows the index at all angles; an index by name is of the reflectance by name.
  const Material given = material(R"("type": "conductor", "reflectance": )" + index).materials[0];
  CHECK(given.eta == Vec3d(1, 2, 0.5));
  CHECK(given.k == Vec3d(2, 0, 1));
  for (const std::string name : {"silver", "gold", "copper", "aluminium", "iron", "chromium"}) {
    const Material m = material(R"("type": "conductor", "reflectance": ")" + name + '"').materials[0];
    const Vec3d one(1),
        r = ((m.eta - one) * (m.eta - one) + m.k * m.k) / ((m.eta + one) * (m.eta + one) + m.k * m.k);
    CAPTURE(name);
    for (int c = 0; c < 3; ++c) CHECK(r[c] == Approx(m.reflectance[c]).margin(0.0011));
  }
  // Glass: coefficients, or what is left after a distance.
  CHECK(material(R"("type": "dielectric", "absorption": [1, 2, 0])").materials[0].absorption ==
        Vec3d(1, 2, 0));
  check_near(material(R"("type": "dielectric", "absorption": { "color": [0.25, 0.5, 1], "distance": 2 })")
                 .materials[0]
                 .absorption,
             Vec3d(std::log(2.), std::log(2.) / 2, 0));
  CHECK(material(R"("type": "conductor", "multiple_scattering": true)").materials[0].multiple_scattering);
  CHECK(material(R"("type": "dielectric", "thin": true)").materials[0].thin);
  // What of a material is glass is a material of its own.
  const Scene scene =
      material(R"("type": "principled", "kd": 0.7, "metallic": 0.2, "transmission": 0.5, "ior": 1.3)");
  REQUIRE(scene.materials.size() == 2);
  CHECK(scene.materials[0].glass == 1);
  CHECK(scene.materials[0].glass_share() == Approx(0.4));
  CHECK(scene.materials[1].type == MaterialType::dielectric);
  CHECK(scene.materials[1].ior == 1.3);
  CHECK(scene.materials[1].transmittance == Vec3d(0.7));
}

TEST_CASE("a light whose image is black everywhere is none") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  write_image(folder / "t.png", Image(2, 2));
  std::ofstream(folder / "s.json") << R"({ "materials": { "m": { "type": "diffuse",
    "ke": { "image": "t.png", "factor": [5, 5, 5] } } }, "meshes": [ { "obj": "t.obj", "material": "m" } ] })";
  CHECK(load_scene(folder / "s.json").lights.empty());
}

TEST_CASE("the brightness of a light without size may be a number, which stands for three") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(folder / "s.json") << R"({ "meshes": [ { "obj": "t.obj" } ], "lights": [
    { "type": "directional", "direction": [0,0,-1], "irradiance": 2 } ] })";
  CHECK(load_scene(folder / "s.json").delta_lights.at(0).intensity == Vec3d(2));
}
