#include <catch2/catch.hpp>

#include <functional>

#include "box_scenes.h"
#include "castray_blocks.h"
#include "instanced.h"
#include "integrators.h"
#include "materials/texture.h"

using namespace castray;
using namespace castray::test;

// What differs from point to point of a surface: the kernels against castRay in double precision. Each
// `check` has a false-alarm rate of 1e-4.

namespace {

/// 4 x 4 texels between `low` and `high`, different in each channel.
Texture noise_image(double low, double high) {
  Image image(4, 4);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const auto step = static_cast<double>((7 * i + 5 * static_cast<std::size_t>(c)) % 11) / 10;
      image.pixels[i][c] = static_cast<float>(low + (high - low) * step);
    }
  return make_texture("noise", image);
}

/// The scene with texture coordinates on every triangle, those of every second one mirrored, and vertex
/// colours.
Scene with_coordinates(Scene scene) {
  scene.uvs = {{0, 0}, {2, 0}, {0, 1.5f}};
  scene.colors = {{1, 0.2f, 0.2f}, {0.2f, 1, 0.2f}, {0.2f, 0.2f, 1}};
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    scene.triangle_uvs.push_back(t % 2 ? Index3{0, 1, 2} : Index3{1, 0, 2});
    scene.triangle_colors.push_back({0, 1, 2});
  }
  return scene;
}

/// Puts an image with values from `low` to `high` on a parameter.
void put_image(Scene& scene, Material& m, SurfaceParameter parameter, double low, double high) {
  m.map(parameter).texture = static_cast<int>(scene.textures.size());
  scene.textures.push_back(noise_image(low, high));
}

/// Cornell's box with images, where `change` makes something of the boxes' material.
Scene box_with(const std::function<void(Scene&, Material&)>& change) {
  Scene scene = with_coordinates(standard_scene("cornell_conductor"));
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (scene.materials[i].type == MaterialType::conductor) {
      Material m = scene.materials[i];
      change(scene, m);
      scene.materials[i] = m;
    }
  return scene;
}

/// The box whose `names`, the light or walls that glow, have an image of what they emit.
Scene with_glowing_images(const std::vector<std::string>& names) {
  Scene scene = with_coordinates(standard_scene("cornell_box"));
  for (const std::string& name : names)
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
      if (scene.materials[i].name == name) {
        Material m = scene.materials[i];
        put_image(scene, m, SurfaceParameter::ke, 0, 2);
        if (!m.emits()) m.ke = {2, 1, 0.5};
        scene.materials[i] = m;
      }
  scene.lights.clear();
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t)
    if (scene.material_of(t).emits()) scene.lights.push_back(t);
  return scene;
}

Scene with_everything() {
  Scene scene = with_glowing_images({"light", "red"});
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    Material m = scene.materials[i];
    m.type = MaterialType::principled;
    m.ks = {0.5, 0.3, 0.2};
    m.alpha = 0.5;
    m.metallic = 0.7;
    m.sheen = m.clearcoat = m.clearcoat_roughness = 0.8;
    m.vertex_colors = i % 2;
    put_image(scene, m, SurfaceParameter::kd, 0.2, 1);
    put_image(scene, m, SurfaceParameter::ks, 0.1, 1);
    put_image(scene, m, SurfaceParameter::roughness, 0.4, 1);
    put_image(scene, m, SurfaceParameter::metallic, 0, 1);
    put_image(scene, m, SurfaceParameter::sheen, 0, 1);
    put_image(scene, m, SurfaceParameter::clearcoat, 0, 1);
    put_image(scene, m, SurfaceParameter::clearcoat_roughness, 0.3, 1);
    put_image(scene, m, SurfaceParameter::normal, 0.35, 0.65);
    scene.materials[i] = m;
  }
  return scene;
}

}  // namespace

TEST_CASE("the wavefront agrees with castRay on colours by image and by vertex", "[statistical]") {
  check_scene("reflectance", box_with([](Scene& s, Material& m) {
                put_image(s, m, SurfaceParameter::reflectance, 0.1, 1);
              }));
  check_scene("kd and ks", box_with([](Scene& s, Material& m) {
                m = {.name = "coat",
                     .type = MaterialType::microfacet,
                     .kd = Vec3d(0.9),
                     .ks = Vec3d(0.9),
                     .alpha = 0.3};
                put_image(s, m, SurfaceParameter::kd, 0, 1);
                put_image(s, m, SurfaceParameter::ks, 0, 1);
              }));
  check_scene("vertex colours", box_with([](Scene&, Material& m) {
                m = {.name = "painted", .kd = Vec3d(0.9)};
                m.vertex_colors = true;
              }));
  check_scene("tinted glass", box_with([](Scene& s, Material& m) {
                m = {.name = "glass", .type = MaterialType::dielectric, .alpha = 0.3};
                m.transmittance = {0.9, 0.6, 0.3};
                put_image(s, m, SurfaceParameter::transmittance, 0.5, 1);
              }));
}

TEST_CASE("the wavefront agrees with castRay on numbers by image", "[statistical]") {
  check_scene("metal's alpha", box_with([](Scene& s, Material& m) {
                m.alpha = 1;
                put_image(s, m, SurfaceParameter::alpha, 0.2, 1);
              }),
              12);
  check_scene("coat's roughness", box_with([](Scene& s, Material& m) {
                m = {.name = "coat", .type = MaterialType::microfacet, .ks = Vec3d(0.6), .alpha = 1};
                put_image(s, m, SurfaceParameter::roughness, 0.3, 1);
              }),
              12);
  const Scene glass = box_with([](Scene& s, Material& m) {
    m = {.name = "glass", .type = MaterialType::dielectric, .alpha = 1};
    put_image(s, m, SurfaceParameter::alpha, 0.2, 0.6);
  });
  check_scene("glass's alpha", with_larger_lamps(glass, 3), 12);
  check_scene("clear coat, sheen and roughness", box_with([](Scene& s, Material& m) {
                m = {.name = "paint",
                     .type = MaterialType::principled,
                     .kd = {0.9, 0.1, 0.1},
                     .ks = Vec3d(0.04),
                     .alpha = 1,
                     .metallic = 0.5,
                     .sheen = 0.5,
                     .clearcoat = 0.8,
                     .clearcoat_roughness = 0.3};
                put_image(s, m, SurfaceParameter::roughness, 0.3, 1);
              }),
              12);
  check_scene("clear coat, its roughness and sheen", box_with([](Scene& s, Material& m) {
                m = {.name = "cloth",
                     .type = MaterialType::principled,
                     .kd = {0.9, 0.1, 0.1},
                     .ks = Vec3d(0.04),
                     .alpha = 0.3,
                     .sheen = 1,
                     .clearcoat = 1,
                     .clearcoat_roughness = 1};
                put_image(s, m, SurfaceParameter::sheen, 0, 1);
                put_image(s, m, SurfaceParameter::clearcoat, 0, 1);
                put_image(s, m, SurfaceParameter::clearcoat_roughness, 0.2, 1);
              }),
              12);
  check_scene("metallic", box_with([](Scene& s, Material& m) {
                m = {.name = "blend",
                     .type = MaterialType::principled,
                     .kd = {0.9, 0.6, 0.2},
                     .ks = Vec3d(0.04),
                     .alpha = 0.3,
                     .metallic = 1};
                put_image(s, m, SurfaceParameter::metallic, 0, 1);
              }),
              12);
}

TEST_CASE("light points on an image that emits are unbiased", "[statistical]") {
  // Without MIS a glowing wall makes rare bright samples, too few here for a z-test.
  const std::pair<std::vector<std::string>, std::vector<Switch>> cases[] = {
      {{"light"}, {Switch::on, Switch::off}}, {{"light", "red"}, {Switch::on}}};
  for (const auto& [names, switches] : cases) {
    const Scene scene = with_glowing_images(names);
    RenderOptions reference = wavefront_options(32);
    reference.mis = Switch::on;
    const Expected expected(scene, reference);
    for (const Switch mis : switches) {
      for (const LightSampling lights : {LightSampling::area, LightSampling::tree}) {
        RenderOptions options = wavefront_options(16);
        options.mis = mis;
        options.lights = lights;
        CAPTURE(names.size(), static_cast<int>(mis), static_cast<int>(lights));
        expected.check("shared", scene, options);
        expected.check("plain", scene, plain(options));
      }
      RenderOptions independent = as_reference(reference);
      independent.mis = mis;
      independent.precision = Precision::float32;
      expected.check("reference in float", scene, independent);
    }
  }
}

TEST_CASE("the wavefront agrees with castRay on bent normals", "[statistical]") {
  const auto bent = [](SurfaceParameter parameter, double low, double high, float gain) {
    return box_with([=](Scene& s, Material& m) {
      m.alpha = 0.4;
      put_image(s, m, parameter, low, high);
      m.map(parameter).gain = gain;
      for (Material& wall : s.materials)
        if (wall.name == "white") wall.map(parameter) = m.map(parameter);
    });
  };
  check_scene("normal map", bent(SurfaceParameter::normal, 0.3, 0.9, 1));
  check_scene("bump map", bent(SurfaceParameter::bump, 0, 1, 40));
}

TEST_CASE("kernels agree with castRay where everything differs from point to point", "[statistical]") {
  const Scene scene = with_everything(), instanced = as_instances(scene, kinds_of_places());
  RenderOptions reference = wavefront_options(4);
  reference.mis = Switch::on;
  const Expected expected(scene, reference);
  check_same_bytes(scene, wavefront_options(2));
  check_same_bytes(instanced, wavefront_options(2));
  for (const std::string& isa : arithmetics()) {
    RenderOptions options = wavefront_options(has_fma(isa) ? 2 : 1);
    options.isa = isa;
    options.mis = Switch::on;
    expected.check(isa, scene, options);
    expected.check(isa + ", plain", scene, plain(options));
    expected.check(isa + ", instances", instanced, options);
  }
  RenderOptions options = wavefront_options(4);
  options.mis = Switch::on;
  expected.check("instances, plain", instanced, plain(options));
  RenderOptions in_float = as_reference(reference);
  in_float.precision = Precision::float32;
  in_float.seed = 7;
  in_float.spp = 2;
  expected.check("reference in float", scene, in_float);
  expected.check("reference in float, instances", instanced, in_float);
}
