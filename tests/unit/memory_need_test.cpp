#include "plan/memory_need.h"

#include <catch2/catch.hpp>

#include <malloc.h>

#include <fstream>

#include "generate/shapes.h"
#include "plan/job.h"
#include "test_scenes.h"

using namespace castray;

namespace {

/// A line of /proc/self/status, in bytes.
double status(const std::string& key) {
  std::ifstream in("/proc/self/status");
  for (std::string name; in >> name; in.ignore(256, '\n'))
    if (double kilobytes = 0; name == key + ":" && in >> kilobytes) return 1024 * kilobytes;
  throw std::runtime_error("no " + key);
}

/// How much memory the work takes at most, of that in the machine.
template <class Work>
double peak_of(Work work) {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak is that from here on
  const double before = status("VmRSS");
  work();
  return status("VmHWM") - before;
}

Scene scene_of(const char* shape, std::uint32_t triangles, const Vec3d& emission) {
  test::SceneSketch sketch;
  const Shape mesh = make_shape(shape, triangles, 1);
  sketch.add_mesh(mesh.positions, mesh.triangles, 1, {}, false,
                  sketch.add_material({.name = "all", .ke = emission}));
  sketch.scene.environment = {1, 1, 1};
  return std::move(sketch.scene);
}

struct Case {
  const char* shape;
  std::uint32_t triangles;
  bool glows = false;
  BuildQuality build = BuildQuality::automatic;
  Integrator integrator = Integrator::wavefront;
  AccelKind accel = AccelKind::automatic;
};

}  // namespace

TEST_CASE("what a scene takes while it is prepared is known beforehand", "[memory]") {
  const auto [shape, triangles, glows, build, integrator, accel] = GENERATE(values<Case>({
      {"terrain", 1200000},
      {"hair", 300000},
      {"sticks", 100000, false, BuildQuality::best},
      {"blob", 80000, true},
      {"soup", 80000, true},
      {"soup", 300000, false, BuildQuality::fast, Integrator::reference},
      {"soup", 80000, true, BuildQuality::fast, Integrator::reference},
      {"soup", 8000, false, BuildQuality::fast, Integrator::wavefront, AccelKind::list},
  }));
  CAPTURE(shape, triangles, glows);
  const Scene scene = scene_of(shape, triangles, Vec3d(glows ? 1 : 0));
  RenderOptions options;
  options.width = options.height = 8;
  options.threads = 1;  // what several free, and when, is a matter of chance
  options.build = build;
  options.integrator = integrator;
  options.accel = accel;
  const Plan plan = make_plan(scene, options, window_of(8, 8, options));
  const double told = static_cast<double>(bytes_to_prepare(scene, plan, integrator));
  const double taken = peak_of([&] { const PreparedScene prepared(scene, options); });
  CHECK(taken <= told);
  // glibc keeps blocks that are free for the next ones, or not: hair takes 24 to 36 MB of the 55 told
  CHECK(taken >= 0.4 * told);
}
