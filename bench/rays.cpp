// Rays per second through castray's accelerators, on meshes and rays from files, so that any other library
// can be held against it on the same rays (bench/embree_rays.cpp does). Also makes the standard sets of rays.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "accel/bvh.h"
#include "accel/list.h"
#include "accel/wide_bvh.h"
#include "integrate/wavefront.h"
#include "ray_files.h"
#include "ray_sets.h"

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

/// An accelerator and how it traces a run of rays.
class Tracer {
 public:
  virtual ~Tracer() = default;
  virtual BvhStats build(int threads) = 0;
  virtual void trace(const RaySet& rays, bool any, std::size_t first, std::size_t count,
                     RayResult* out) const = 0;
};

class WideTracer : public Tracer {
 public:
  WideTracer(const MeshView& mesh, const KernelApi& kernel, BuildQuality quality)
      : mesh_(mesh), kernel_(kernel), quality_(quality) {}

  BvhStats build(int threads) override {
    bvh_ = WideBvh::build(mesh_, threads, quality_);
    return bvh_.stats();
  }

  void trace(const RaySet& rays, bool any, std::size_t first, std::size_t count,
             RayResult* out) const override {
    constexpr std::size_t batch = 512;
    for (std::size_t i = first; i < first + count; i += batch) {
      const auto n = static_cast<std::uint32_t>(std::min(batch, first + count - i));
      float t[batch], b1[batch], b2[batch];
      std::uint32_t triangle[batch];
      std::uint8_t occluded[batch];
      const auto in = [&](int number) { return rays.number[number].data() + i; };
      if (any) {
        kernel_.bvh_occluded(bvh_.view(), {in(0), in(1), in(2), in(3), in(4), in(5), in(6), occluded, n});
        for (std::uint32_t r = 0; r < n; ++r) out[i + r] = any_result(occluded[r]);
      } else {
        kernel_.bvh_closest(bvh_.view(),
                            {in(0), in(1), in(2), in(3), in(4), in(5), in(6), t, triangle, b1, b2, n});
        for (std::uint32_t r = 0; r < n; ++r) out[i + r] = {t[r], triangle[r]};
      }
    }
  }

 private:
  MeshView mesh_;
  const KernelApi& kernel_;
  BuildQuality quality_;
  WideBvh bvh_;
};

/// Bvh or TriangleList: one ray at a time, in plain C++.
template <class Accelerator>
class PlainTracer : public Tracer {
 public:
  explicit PlainTracer(const MeshView& mesh) : mesh_(mesh) {}

  BvhStats build(int threads) override {
    if constexpr (std::is_same_v<Accelerator, Bvh>) {
      accelerator_ = std::make_unique<Bvh>(Bvh::build(mesh_, threads));
      return accelerator_->stats();
    } else {
      accelerator_ = std::make_unique<TriangleList>(mesh_);
      return {.triangles = mesh_.count};
    }
  }

  void trace(const RaySet& rays, bool any, std::size_t first, std::size_t count,
             RayResult* out) const override {
    const auto& n = rays.number;
    for (std::size_t i = first; i < first + count; ++i) {
      const Ray<float> ray{{n[0][i], n[1][i], n[2][i]}, {n[3][i], n[4][i], n[5][i]}, n[6][i]};
      if (any) {
        out[i] = any_result(accelerator_->occluded(ray));
      } else {
        const Hit<float> hit = accelerator_->closest(ray);
        out[i] = {hit.t, hit.triangle};
      }
    }
  }

 private:
  MeshView mesh_;
  std::unique_ptr<Accelerator> accelerator_;
};

struct Options {
  std::string mesh, rays, accel = "wide", isa = "auto", mode = "closest", out, build = "fast";
  int threads = 1, repeat = 5;
  std::string make, write;
  RaySetOptions set;
};

std::unique_ptr<Tracer> make_tracer(const Options& options, const MeshView& mesh) {
  if (options.accel == "bvh2") return std::make_unique<PlainTracer<Bvh>>(mesh);
  if (options.accel == "list") return std::make_unique<PlainTracer<TriangleList>>(mesh);
  return std::make_unique<WideTracer>(mesh, choose_kernel(options.isa),
                                      options.build == "best" ? BuildQuality::best : BuildQuality::fast);
}

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
  const RaySet rays = read_rays(options.rays);
  if (rays.size() == 0) throw InputError({options.rays}, "holds no ray");
  const std::unique_ptr<Tracer> tracer = make_tracer(options, mesh);
  BvhStats stats;
  double build_seconds[2];
  for (const int threads : {1, 2}) {
    std::vector<double> seconds;
    for (int i = 0; i < options.repeat; ++i) seconds.push_back((stats = tracer->build(threads)).seconds);
    build_seconds[threads - 1] = median(seconds);
  }

  std::vector<RayResult> results(rays.size());
  constexpr std::int64_t run = 4096;
  const auto count = static_cast<std::int64_t>(rays.size());
  std::vector<double> seconds;
  for (int i = 0; i < options.repeat; ++i) {
    const auto start = std::chrono::steady_clock::now();
#pragma omp parallel for schedule(dynamic) num_threads(options.threads)
    for (std::int64_t first = 0; first < count; first += run) {
      tracer->trace(rays, options.mode == "any", static_cast<std::size_t>(first),
                    static_cast<std::size_t>(std::min(run, count - first)), results.data());
    }
    seconds.push_back(seconds_since(start));
  }
  if (!options.out.empty()) write_results(results, options.out);
  fmt::print("{} triangles, {} rays, {} hit; {}, {}, {} threads\n", mesh.count, count, count_hits(results),
             options.accel, options.accel == "wide" ? choose_kernel(options.isa).name : "plain",
             options.threads);
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
