#include <catch2/catch.hpp>

#include <string>

#include "castray_blocks.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// The wavefront, in all its forms, against castRay in double precision through every camera.

namespace {

const char* const names[] = {"disc", "blades", "orthographic", "panorama", "shift"};

/// The scene, in scene space, through another camera.
Scene through(const std::string& name, Scene scene) {
  Camera& camera = scene.camera;
  if (name == "disc") camera.lens = {.radius = 0.2, .focus_distance = length(camera.position)};
  if (name == "blades")
    camera.lens = {
        .radius = 0.3, .focus_distance = length(camera.position) - 0.4, .blades = 5, .rotation = 20};
  if (name == "orthographic") camera.projection = Projection::orthographic;
  if (name == "panorama") camera.projection = Projection::panorama, camera.position = camera.position * 0.3;
  if (name == "shift") camera.shift_x = 0.1, camera.shift_y = -0.2;
  return scene;
}

}  // namespace

TEST_CASE("through every camera the wavefront agrees with castRay", "[statistical]") {
  for (const char* name : names) {
    check_scene(std::string(name) + ", box", through(name, standard_scene("cornell_box")));
    check_scene(std::string(name) + ", outdoors", through(name, standard_scene("kinds/sky_and_ground")));
  }
}

// Paths from lights are connected to each camera. The lamps are large, so that castRay finds them by the
// mirrors often enough.
TEST_CASE("through every camera caustics agree with castRay", "[statistical]") {
  Scene room = standard_scene("kinds/big_panels");
  for (Material& m : room.materials)
    if (m.name == "red" || m.name == "green") m.type = MaterialType::conductor, m.alpha = 0;
  for (const char* name : names) {
    const Scene scene = through(name, room);
    const Expected expected(scene);
    for (const bool shared : {true, false}) {
      RenderOptions options = wavefront_options(8);
      options.caustics = Switch::on;
      options.reuse.automatic = shared;
      expected.check(std::string(name) + (shared ? ", shared" : ", plain"), scene, options);
    }
  }
}

TEST_CASE("every form of the wavefront has the same mean through a lens", "[statistical]") {
  const Scene scene = through("blades", standard_scene("cornell_box"));
  const Expected expected(scene);
  expected.check_each_kernel(scene);
  expected.check_with("generic", scene, [](RenderOptions& o) { o.generic = true; });
  expected.check_with("reconstructed", scene, [](RenderOptions& o) { o.reconstruct = Switch::on; });
  expected.check_with("independent numbers", scene,
                      [](RenderOptions& o) { o.sampler = SamplerKind::independent; });
}

TEST_CASE("without jitter a lens still blurs", "[statistical]") {
  const Scene scene = through("disc", standard_scene("cornell_box"));
  RenderOptions options = wavefront_options(16);
  options.jitter = false;
  const Expected expected(scene, options);
  expected.check("no jitter", scene, options);
}
