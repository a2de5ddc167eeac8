#include <catch2/catch.hpp>

#include "generate/shapes.h"
#include "instanced.h"
#include "integrators.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// No light passes a closed surface: exactly none, by any integrator.

namespace {

RenderOptions small(std::uint64_t spp) {
  RenderOptions options;
  options.width = options.height = 24;
  options.spp = spp;
  options.threads = 1;
  return options;
}

/// How many pixels are not exactly black.
int lit_pixels(const Scene& scene, const RenderOptions& options) {
  const RenderResult result = render(scene, options);
  CHECK(result.film.nonfinite_samples == 0);
  int lit = 0;
  for (const Vec3f& pixel : result.film.image().pixels) lit += pixel != Vec3f();
  return lit;
}

enum class Which { all, double_precision };

void check_black(const std::string& what, const Scene& scene, Which which = Which::all) {
  for (const Way& way : every_way(small(4))) {
    if (which == Which::double_precision && way.name != "reference, double") continue;
    if (way.options.accel == AccelKind::list && scene.triangles.size() > 64) continue;  // never planned
    CAPTURE(what, way.name);
    CHECK(lit_pixels(scene, way.options) == 0);
  }
}

struct Shell {
  std::string name;
  Shape shape;
};

/// Closed shapes around the origin, of few triangles and of many.
std::vector<Shell> shells() { return {{"20 triangles", icosphere(1)}, {"500 triangles", icosphere(5)}}; }

void look(Scene& scene, const Vec3d& from, const Vec3d& at) {
  scene.camera = make_camera(from, at, {0, 1, 0}, 60);
}

const Material white{.name = "white", .kd = Vec3d(1)};
const Material black{.name = "black", .kd = Vec3d(0)};
const Material glowing{.name = "glowing", .kd = Vec3d(0.5), .ke = Vec3d(1)};

/// What lets every ray through unchanged, but makes it start anew.
const Material air{.name = "air", .type = MaterialType::dielectric, .alpha = 0, .ior = 1};

}  // namespace

TEST_CASE("nothing gets into a sealed shell around the camera, from a lit room or the sky") {
  for (const Shell& shell : shells())
    for (const Material& material : {white, black}) {
      SceneSketch sketch;
      sketch.scene.environment = {1, 1, 1};
      const auto wall = sketch.add_material(glowing), inner = sketch.add_material(material);
      sketch.add_cube(1, {}, true, wall);
      sketch.add_mesh(shell.shape.positions, shell.shape.triangles, 0.3, {0.1, 0.2, 0.05}, false, inner);
      look(sketch.scene, {0.1, 0.2, 0.1}, {0.3, 0.1, -0.2});
      check_black(shell.name, sketch.scene);
    }
}

TEST_CASE("nothing gets out of a sealed lit room, onto its walls or the floor around it") {
  for (const Shell& shell : shells()) {
    SceneSketch sketch;
    const auto lamp = sketch.add_material(glowing), outside = sketch.add_material(white);
    sketch.add_mesh(shell.shape.positions, shell.shape.triangles, 0.4, {0, 0, 0}, true, lamp);
    sketch.add_quad({-1, -0.4f, 1}, {1, -0.4f, 1}, {1, -0.4f, -1}, {-1, -0.4f, -1}, outside);
    look(sketch.scene, {0.3, 0.5, 0.9}, {0, -0.2, 0});
    check_black(shell.name, sketch.scene);
  }
}

// Where a near and a far facet meet, at an outline, rounding must not call the far one the nearer.
TEST_CASE("no spark of a shining inside is seen at the outlines of flat lists") {
  SceneSketch sketch;
  const Shape shell = icosphere(1);
  const auto lamp = sketch.add_material(glowing);
  sketch.add_mesh(shell.positions, shell.triangles, 0.4, {0, 0, 0}, true, lamp);
  look(sketch.scene, {0.3, 0.5, 0.9}, {0, 0, 0});
  RenderOptions many = small(64);
  many.width = many.height = 96;
  for (const Way& way : every_way(many)) {
    if (way.options.integrator == Integrator::reference || way.options.accel != AccelKind::list) continue;
    CAPTURE(way.name);
    CHECK(lit_pixels(sketch.scene, way.options) == 0);
  }
}

namespace {

/// Two spheres around the origin, the outer one larger by `gap`.
struct TwoSpheres {
  Shape shape;
  double gap;

  SceneSketch sketch(const Material& inner, const Material& outer, bool outer_faces_inwards = false) const {
    SceneSketch sketch;
    const auto in = sketch.add_material(inner), out = sketch.add_material(outer);
    sketch.add_mesh(shape.positions, shape.triangles, 0.5, {}, false, in);
    sketch.add_mesh(shape.positions, shape.triangles, 0.5 * (1 + gap), {}, outer_faces_inwards, out);
    return sketch;
  }
};

void look_from_inside(Scene& scene) { look(scene, {0.01, 0.02, 0.03}, {0.3, 0.2, -1}); }
void look_from_outside(Scene& scene) {
  look(scene, {0, 0, 0.95}, {0, 0, 0});
  scene.camera.tan_half_fov = 0.2;
}

/// Rays that start on one sphere meet the other.
void check_origins(const std::string& what, const TwoSpheres& spheres, Which which = Which::all) {
  SceneSketch out = spheres.sketch(air, black);
  out.scene.environment = {1, 1, 1};
  look_from_inside(out.scene);
  check_black(what + ", out through air", out.scene, which);
  SceneSketch in = spheres.sketch(black, air);
  in.add_cube(0.1, {}, false, in.add_material(glowing));
  look_from_outside(in.scene);
  check_black(what + ", in through air", in.scene, which);
}

/// Segments to a light on the far sphere are blocked by the near one.
void check_segments(const std::string& what, const TwoSpheres& spheres, Which which = Which::all) {
  SceneSketch within = spheres.sketch(glowing, white);
  look_from_outside(within.scene);
  check_black(what + ", lit from within", within.scene, which);
  SceneSketch without = spheres.sketch(white, glowing, true);
  look_from_inside(without.scene);
  check_black(what + ", lit from without", without.scene, which);
}

}  // namespace

// The origin of a ray, or of a segment from a light, is pushed by the error of its own triangle, which grows
// with the triangle's size.
TEST_CASE("of two spheres a millionth apart, each hides what is behind the other") {
  check_origins("small triangles", {icosphere(16), 1e-6});
  check_origins("large triangles", {icosphere(1), 2e-5});
  check_origins("in double", {icosphere(1), 1e-6}, Which::double_precision);
}

TEST_CASE("of two spheres, one shining away from the other, no light reaches the other's far side") {
  check_segments("small triangles", {icosphere(16), 1e-6});
  check_segments("large triangles", {icosphere(1), 2e-5});
  check_segments("in double", {icosphere(1), 1e-6}, Which::double_precision);
}

TEST_CASE("no light passes a sealed shell that is an instance") {
  const std::vector<Transform> places = kinds_of_places();
  std::size_t next = 0;
  for (const Shell& shell : shells())
    for (const Material& material : {white, black, air}) {
      SceneSketch sketch;
      const auto lamp = sketch.add_material(glowing), around = sketch.add_material(black),
                 inner = sketch.add_material(material);
      sketch.add_cube(1, {}, true, lamp);
      sketch.add_mesh(shell.shape.positions, shell.shape.triangles, 0.3, {0.1, 0.2, 0.05}, false, around);
      sketch.add_mesh(shell.shape.positions, shell.shape.triangles, 0.29, {0.1, 0.2, 0.05}, false, inner);
      look(sketch.scene, {0.1, 0.2, 0.1}, {0.3, 0.1, -0.2});
      const Transform& place = places[next++ % places.size()];
      const Scene scene = as_instances(sketch.scene, {place, place});
      for (const Way& way : every_way(small(4))) {
        if (way.options.accel == AccelKind::list) continue;
        CAPTURE(shell.name, material.name, way.name);
        CHECK(lit_pixels(scene, way.options) == 0);
      }
    }
}
