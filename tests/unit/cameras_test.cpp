#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "castray/image.h"
#include "castray/render.h"
#include "cli/scene_report.h"
#include "integrators.h"
#include "temporary_folder.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

/// A scene of one triangle with this "camera".
Scene seen_by(const std::string& camera) {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << "v 0 0 0\nv 10 0 0\nv 0 8 0\nf 1 2 3\n";
  std::ofstream(folder / "s.json") << "{ " << camera << R"(, "meshes": [ { "obj": "t.obj" } ] })";
  return load_scene(folder / "s.json");
}

Camera camera_of(const std::string& keys) {
  const Scene scene = seen_by(R"("camera": { "position": [0, 0, 5], "look_at": [0, 0, 1], )" + keys + " }");
  return scene.to_world(scene.camera);
}

void check_near(const Vec3d& found, const Vec3d& expected) {
  INFO(found.x << ' ' << found.y << ' ' << found.z);
  for (int i = 0; i < 3; ++i) CHECK(found[i] == Approx(expected[i]).margin(1e-12));
}

}  // namespace

TEST_CASE("a lens is read in the scene's units") {
  const Camera wide = camera_of(R"("lens": { "radius": 0.25, "focus_distance": 3 })");
  CHECK(wide.lens.radius == Approx(0.25));
  CHECK(wide.lens.focus_distance == Approx(3));
  CHECK(wide.lens.blades == 0);
  const Camera at_look_at = camera_of(R"("lens": { "radius": 0.25, "blades": 6, "rotation": 10 })");
  CHECK(at_look_at.lens.focus_distance == Approx(4));
  CHECK(at_look_at.lens.blades == 6);
  CHECK(at_look_at.lens.rotation == 10);
  CHECK(camera_of(R"("lens": { "radius": 1, "focus_on": [7, -3, 2] })").lens.focus_distance == Approx(3));
  // A sensor of 24 mm behind a focal length of 12 mm / tan(20 degrees); f/2 halves it, the radius is half.
  const double focal = 0.012 / std::tan(20 * std::numbers::pi / 180);
  CHECK(camera_of(R"("lens": { "f_number": 2, "sensor_height": 0.024 })").lens.radius == Approx(focal / 4));
}

TEST_CASE("the view that info prints as JSON is the same camera") {
  for (const char* keys : {R"("fov": 30, "shift": [0.25, -0.5])",
                           R"("lens": { "radius": 0.25, "focus_distance": 3, "blades": 5, "rotation": 12 })",
                           R"("type": "orthographic", "height": 7)", R"("type": "panorama")"}) {
    const Scene scene =
        seen_by(R"("camera": { "position": [1, 2, 5], "look_at": [0, 1, 1], )" + std::string(keys) + " }");
    const Scene again = seen_by(cli::view_json(scene, scene.camera));
    for (const double x : {0.0, 3.7, 10.0}) {
      const CameraRay a = scene.camera.ray(x, 2.5, 10, 8, 0.3, 0.6),
                      b = again.camera.ray(x, 2.5, 10, 8, 0.3, 0.6);
      CAPTURE(keys, x);
      CHECK(length(a.origin - b.origin) < 1e-5);
      CHECK(length(a.direction - b.direction) < 1e-5);
    }
  }
}

TEST_CASE("points of a lens are uniform: area, centre, second moment") {
  for (const int blades : {0, 3, 5, 6}) {
    const Lens lens{.radius = 1, .blades = blades, .rotation = 25};
    constexpr int n = 400;
    double inner = 0, right = 0, up = 0, squares = 0;
    for (int i = 0; i < n * n; ++i) {
      const Lens::Point p = lens.sample((i % n + 0.5) / n, (i / n + 0.5) / n);
      const double r2 = p.right * p.right + p.up * p.up;
      right += p.right, up += p.up, squares += r2;
      if (blades == 0) {
        inner += r2 < 0.25;
      } else {  // the same polygon at half the size
        double farthest = -1;
        for (int k = 0; k < blades; ++k) {
          const double side = 2 * std::numbers::pi * ((k + 0.5) / blades + 25.0 / 360);
          farthest = std::max(farthest, p.right * std::sin(side) + p.up * std::cos(side));
        }
        REQUIRE(farthest < std::cos(std::numbers::pi / blades) + 1e-9);
        inner += farthest < std::cos(std::numbers::pi / blades) / 2;
      }
    }
    const double count = n * n;
    CAPTURE(blades);
    CHECK(inner / count == Approx(0.25).margin(1e-2));
    CHECK(right / count == Approx(0).margin(1e-4));
    CHECK(up / count == Approx(0).margin(1e-4));
    const double polygon = (2 + std::cos(2 * std::numbers::pi / std::max(blades, 1))) / 6;
    CHECK(squares / count == Approx(blades == 0 ? 0.5 : polygon).epsilon(1e-3));
  }
  const Lens::Point corner = Lens{.radius = 1, .blades = 5}.sample(1, 0);
  CHECK(corner.right == Approx(0).margin(1e-12));
  CHECK(corner.up == Approx(1));
}

TEST_CASE("rays through every point of a lens meet in the plane in focus") {
  Camera camera = make_camera({1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 50);
  camera.lens = {.radius = 0.5, .focus_distance = 4, .blades = 7};
  for (const double u : {0.0, 0.4, 0.99}) {
    const CameraRay ray = camera.ray(3, 5, 20, 10, u, 0.7), middle = camera.ray(3, 5, 20, 10, 0, 0);
    CHECK(dot(ray.origin - camera.position, camera.forward) == Approx(0).margin(1e-12));
    check_near(ray.origin + ray.direction * 4, middle.origin + middle.direction * 4);
  }
}

TEST_CASE("orthographic rays are parallel, and the image is as high as was asked for") {
  Camera camera = make_camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40);
  camera.projection = Projection::orthographic;
  camera.half_height = 3;
  check_near(camera.ray(0, 0, 20, 10, 0, 0).origin, {-6, 3, 5});
  check_near(camera.ray(20, 10, 20, 10, 0, 0).origin, {6, -3, 5});
  check_near(camera.ray(7, 2, 20, 10, 0, 0).direction, {0, 0, -1});
}

TEST_CASE("a panorama has forward in its middle, right at three quarters, up at the top") {
  Camera camera = make_camera({}, {0, 0, -1}, {0, 1, 0}, 40);
  camera.projection = Projection::panorama;
  check_near(camera.ray(10, 5, 20, 10, 0, 0).direction, {0, 0, -1});
  check_near(camera.ray(15, 5, 20, 10, 0, 0).direction, {1, 0, 0});
  check_near(camera.ray(0, 5, 20, 10, 0, 0).direction, {0, 0, 1});
  check_near(camera.ray(4, 0, 20, 10, 0, 0).direction, {0, 1, 0});
}

TEST_CASE("a shifted image is a window beside the image of the same camera") {
  Camera camera = make_camera({1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 50);
  const CameraRay straight = camera.ray(15, 2, 20, 10, 0, 0);
  camera.shift_x = 0.25, camera.shift_y = -0.1;  // 5 pixels to the right, 1 downwards
  check_near(camera.ray(10, 1, 20, 10, 0, 0).direction, straight.direction);
}

TEST_CASE("without jitter every way sees the same through each camera") {
  Scene scene = standard_scene("cornell_box");
  const auto sees_alike = [&scene](const std::string& name) {
    RenderOptions options = wavefront_options(32, 1, 1);
    options.jitter = false;
    options.max_depth = 1;
    Image expected;
    for (const Way& way : every_way(options)) {
      const Image image = render(scene, way.options).film.image();
      if (expected.pixels.empty()) expected = image;
      int different = 0;
      for (std::size_t i = 0; i < image.pixels.size(); ++i)
        different += image.pixels[i] != expected.pixels[i];
      CAPTURE(name, way.name);
      CHECK(different == 0);
    }
    int lit = 0;
    for (const Vec3f& p : expected.pixels) lit += p.x > 0;
    CAPTURE(name);
    CHECK(lit > 5);
  };
  const Camera pinhole = scene.camera;
  scene.camera.shift_y = 0.3;
  sees_alike("shift");
  scene.camera = pinhole;
  scene.camera.projection = Projection::orthographic;
  scene.camera.forward = normalize(Vec3d{0, 0.6, 1});  // up to the lamp
  scene.camera.position = Vec3d{0, 0.53, 0} - scene.camera.forward * 3;
  scene.camera.up = cross(scene.camera.right, scene.camera.forward);
  sees_alike("orthographic");
  scene.camera = pinhole;
  scene.camera.projection = Projection::panorama;
  scene.camera.position = {};
  sees_alike("panorama");
}
