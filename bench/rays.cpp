// Rays per second through castray's accelerators, on meshes and rays from files, so that any other library
// can be held against it on the same rays (bench/embree_rays.cpp does). Also makes the standard sets of rays.

#include <fmt/core.h>

#include <ostream>

#include "cli/tool_main.h"
#include "geometry/wide_bvh.h"
#include "instanced.h"
#include "ray_bench.h"
#include "ray_sets.h"
#include "tracers.h"
#include "wavefront/choose_kernel.h"

namespace castray {
namespace {

struct Soup {
  std::vector<Vec3f> positions;
  std::vector<Index3> triangles;

  /// `places`: where copies of the mesh are.
  Soup(const std::vector<float>& floats, const std::vector<Transform>& places) {
    for (const Transform& place : places)
      for (std::size_t i = 0; i < floats.size(); i += 3)
        positions.emplace_back(place.point({floats[i], floats[i + 1], floats[i + 2]}));
    for (std::uint32_t i = 0; i < positions.size(); i += 3) triangles.push_back({i, i + 1, i + 2});
  }
  MeshView view() const {
    return {positions.data(), triangles.data(), static_cast<std::uint32_t>(triangles.size())};
  }
};

struct Options : RayBenchOptions {
  std::string accel = "wide", isa = "auto", build = "fast", make, write;
  RaySetOptions set;
};

void write_ray_set(const Options& options, const MeshView& mesh) {
  const WideBvh bvh = WideBvh::build(mesh, options.threads);
  const std::vector<float> rays =
      make_rays(options.make, mesh, bvh.view(), choose_kernel(options.isa), options.set);
  write_file(options.write, [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(rays.data()),
              static_cast<std::streamsize>(rays.size() * sizeof(float)));
  });
  fmt::print("{}: {} {} rays\n", options.write, rays.size() / 7, options.make);
}

void measure(const Options& options, const MeshView& mesh) {
  const KernelApi& kernel = choose_kernel(options.isa);
  const BuildQuality quality = options.build == "best" ? BuildQuality::best : BuildQuality::fast;
  std::unique_ptr<Tracer> tracer;
  measure_build(options, mesh.count, [&](int threads) {
    tracer = options.places.empty()
                 ? make_tracer(options.accel, mesh, kernel, quality)
                 : make_instance_tracer(scene_of(mesh, read_places(options.places)), kernel);
    return timed_build([&] { return tracer->build(threads).bytes; });
  });
  fmt::print("{} triangles, {}, build {}, {} threads\n", mesh.count, tracer->name(), options.build,
             options.threads);
  measure_rays(options,
               [&](const RayArrays& rays, bool any, std::size_t first, std::size_t last, RayResult* results) {
                 const std::size_t count = last - first;
                 if (any) {
                   std::vector<std::uint8_t> occluded(count);
                   tracer->occluded(rays, first, count, occluded.data());
                   for (std::size_t i = 0; i < count; ++i) results[first + i] = any_result(occluded[i] != 0);
                 } else {
                   std::vector<Hit<float>> hits(count);
                   tracer->closest(rays, first, count, hits.data());
                   for (std::size_t i = 0; i < count; ++i) results[first + i] = {hits[i].t, hits[i].triangle};
                 }
               });
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"Rays per second on the meshes and rays of files.", "castray-rays"};
  add_ray_bench_options(app, options);
  app.add_option("--accel", options.accel)
      ->check(CLI::IsMember({"wide", "bvh2", "list"}))
      ->capture_default_str();
  app.add_option("--isa", options.isa, "of wide: auto, scalar, sse4, avx2 or avx512")->capture_default_str();
  app.add_option("--build", options.build)->check(CLI::IsMember({"fast", "best"}))->capture_default_str();
  app.add_option("--make", options.make, "make rays instead")
      ->check(CLI::IsMember({"primary", "bounce", "shadow"}));
  app.add_option("--write", options.write, "where to")->needs("--make");
  app.add_option("--camera", options.set.camera, "position and point looked at: 6 numbers")
      ->delimiter(',')
      ->expected(6);
  app.add_option("--fov", options.set.fov, "vertical, degrees")->capture_default_str();
  app.add_option("--resolution", options.set.resolution)->check(CLI::Range(8, 16384))->capture_default_str();
  app.add_option("--quad", options.set.quad, "of shadow rays: corner and two edges, 9 numbers")
      ->delimiter(',')
      ->expected(9);
  return tool_main(app, argc, argv, [&] {
    const std::vector<float> floats = read_floats(options.mesh, 9);
    const std::vector<Transform> once(1);
    if (options.make.empty()) {
      measure(options, Soup(floats, once).view());
    } else {
      if (options.write.empty()) throw InputError("--make needs --write FILE");
      write_ray_set(options,
                    Soup(floats, options.places.empty() ? once : read_places(options.places)).view());
    }
    return 0;
  });
}

}  // namespace
}  // namespace castray

int main(int argc, char** argv) { return castray::run(argc, argv); }
