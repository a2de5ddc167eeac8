// Rays per second through castray's accelerators, on meshes and rays from files, so that any other library
// can be held against it on the same rays (bench/embree_rays.cpp does). Also makes the standard sets of rays.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <ostream>

#include "accel/wide_bvh.h"
#include "integrate/wavefront.h"
#include "ray_files.h"
#include "ray_sets.h"
#include "tracers.h"

namespace castray {
namespace {

struct Soup {
  std::vector<Vec3f> positions;
  std::vector<Index3> triangles;

  explicit Soup(const std::vector<float>& floats) {
    for (std::size_t i = 0; i < floats.size(); i += 3) {
      positions.push_back({floats[i], floats[i + 1], floats[i + 2]});
    }
    for (std::uint32_t i = 0; i < positions.size(); i += 3) triangles.push_back({i, i + 1, i + 2});
  }
  MeshView view() const {
    return {positions.data(), triangles.data(), static_cast<std::uint32_t>(triangles.size())};
  }
};

struct Options {
  std::string mesh, rays, accel = "wide", isa = "auto", mode = "closest", out, build = "fast";
  int threads = 1, repeat = 5;
  std::string make, write;
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
  const RayArrays rays = read_rays(options.rays);
  if (rays.size() == 0) throw InputError({options.rays}, "holds no ray");
  const KernelApi& kernel = choose_kernel(options.isa);
  const std::unique_ptr<Tracer> tracer = make_tracer(
      options.accel, mesh, kernel, options.build == "best" ? BuildQuality::best : BuildQuality::fast);
  BvhStats stats;
  double build_seconds[2];
  for (const int threads : {1, 2}) {
    std::vector<double> seconds;
    for (int i = 0; i < options.repeat; ++i) seconds.push_back((stats = tracer->build(threads)).seconds);
    build_seconds[threads - 1] = median(seconds);
  }

  const bool any = options.mode == "any";
  std::vector<Hit<float>> hits(any ? 0 : rays.size());
  std::vector<std::uint8_t> occluded(any ? rays.size() : 0);
  constexpr std::int64_t run = 4096;
  const auto count = static_cast<std::int64_t>(rays.size());
  std::vector<double> seconds;
  for (int i = 0; i < options.repeat; ++i) {
    const auto start = std::chrono::steady_clock::now();
#pragma omp parallel for schedule(dynamic) num_threads(options.threads)
    for (std::int64_t first = 0; first < count; first += run) {
      const auto f = static_cast<std::size_t>(first),
                 n = static_cast<std::size_t>(std::min(run, count - first));
      if (any) {
        tracer->occluded(rays, f, n, occluded.data() + f);
      } else {
        tracer->closest(rays, f, n, hits.data() + f);
      }
    }
    seconds.push_back(seconds_since(start));
  }
  std::vector<RayResult> results(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    results[i] = any ? any_result(occluded[i] != 0) : RayResult{hits[i].t, hits[i].triangle};
  }
  if (!options.out.empty()) write_results(results, options.out);
  fmt::print("{} triangles, {} rays, {} hit; {}, {} threads\n", mesh.count, count, count_hits(results),
             tracer->name(), options.threads);
  fmt::print("build {:.4f} s with 1 thread, {:.4f} s with 2; {:.1f} bytes a triangle, depth {}, {} nodes\n",
             build_seconds[0], build_seconds[1], static_cast<double>(stats.bytes) / std::max(1u, mesh.count),
             stats.depth, stats.nodes);
  fmt::print("{} {:.2f} million rays/s\n", options.mode, static_cast<double>(count) / median(seconds) / 1e6);
}

void run(int argc, char** argv) {
  Options options;
  CLI::App app{"Rays per second on the meshes and rays of files.", "castray-rays"};
  app.add_option("mesh", options.mesh, "raw float32, 9 a triangle; castray-generate writes them")->required();
  app.add_option("--rays", options.rays, "raw float32: ox oy oz dx dy dz t_max");
  app.add_option("--accel", options.accel)
      ->check(CLI::IsMember({"wide", "bvh2", "list"}))
      ->capture_default_str();
  app.add_option("--isa", options.isa, "of wide: auto, scalar, sse4, avx2 or avx512")->capture_default_str();
  app.add_option("--build", options.build)->check(CLI::IsMember({"fast", "best"}))->capture_default_str();
  app.add_option("--threads", options.threads)->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--mode", options.mode)->check(CLI::IsMember({"closest", "any"}))->capture_default_str();
  app.add_option("--repeat", options.repeat, "the median is told")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--out", options.out, "t (float32) and triangle (uint32) of each ray");
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
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    app.exit(success);
    return;
  } catch (const CLI::ParseError& error) {
    throw InputError(error.what());
  }
  const Soup soup(read_floats(options.mesh, 9));
  if (!options.make.empty()) {
    if (options.write.empty()) throw InputError("--make needs --write FILE");
    write_ray_set(options, soup.view());
  } else {
    if (options.rays.empty()) throw InputError("give --rays FILE, or --make and --write to make one");
    measure(options, soup.view());
  }
}

}  // namespace
}  // namespace castray

int main(int argc, char** argv) {
  try {
    castray::run(argc, argv);
  } catch (const castray::InputError& error) {
    fmt::print(stderr, "castray-rays: error: {}\n", error.what());
    return 2;
  }
}
