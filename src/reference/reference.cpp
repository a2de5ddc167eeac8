#include "reference/reference.h"

#include <fmt/format.h>

#include <atomic>

#include "geometry/bvh.h"
#include "geometry/flat_slab_list.h"
#include "geometry/list.h"
#include "reference/cast_ray.h"
#include "render/take_samples.h"

namespace castray {

namespace {

/// The scene in the file's own coordinates, rounded to float: what a path tracer without re-centring works
/// on.
Scene in_file_coordinates(Scene scene) {
  for (Vec3f& p : scene.positions) p = Vec3f(scene.to_world(Vec3d(p)));
  scene.camera.position = scene.to_world(scene.camera.position);
  scene.center = {};
  scene.unit = 1;
  return scene;
}

/// Fault shared_counter: where the n-th finished pixel goes if threads count pixels together.
struct SharedCounter {
  std::atomic<std::uint64_t> next = 0;

  NonfiniteSample place(const Window& w) {
    const auto width = static_cast<std::uint64_t>(w.width()), height = static_cast<std::uint64_t>(w.height());
    const std::uint64_t i = next++ % (width * height);
    return {w.x0 + static_cast<int>(i % width), w.y0 + static_cast<int>(i / width)};
  }
};

template <class T, class Accel>
RenderResult trace(const Scene& scene, const Accel& accel, const RenderOptions& options,
                   const ProgressCallback& progress, const Film* start) {
  const CastRay<T, Accel> tracer(scene, accel, options);
  SharedCounter counter;
  const auto render_rows = [&](int y0, int y1, const SampleRange& samples, const SampleMap& map, Film& film,
                               RowStats& stats) {
    const Window& w = film.window();
    for (int y = y0; y < y1; ++y)
      for (int x = w.x0; x < w.x1; ++x) {
        NonfiniteSample at{x, y};
        if (options.fault == Fault::shared_counter) at = counter.place(w);
        for (std::uint64_t s = samples.first; s < samples.first + samples.count && map.wants(x, y, s); ++s) {
          Vec3f radiance(tracer.sample_pixel(x, y, w.full_width, w.full_height, s, stats.rays));
          if (!is_finite(radiance)) {
            if (options.fault != Fault::white_specks) {
              stats.nonfinite.push_back({x, y, s});
              continue;
            }
            radiance =
                Vec3f(static_cast<float>(options.spp));  // clamped to white, however many others there are
          }
          film.add(at.x, at.y, radiance);
        }
      }
  };
  return take_samples(scene, options, progress, start, {.render = render_rows});
}

template <class T>
RenderResult trace(const Scene& scene, const RenderOptions& options, const ProgressCallback& progress,
                   const Film* start) {
  if (options.fault == Fault::vanishing_boxes)
    return trace<T>(scene, FlatSlabList<T>(mesh_of(scene)), options, progress, start);
  const bool list = options.accel == AccelKind::list ||
                    (options.accel == AccelKind::automatic && scene.triangles.size() <= longest_list);
  if (list) {
    RenderResult result = trace<T>(scene, TriangleList(mesh_of(scene)), options, progress, start);
    result.stats.accel_summary = fmt::format("list: {} triangles", scene.triangles.size());
    return result;
  }
  const Bvh bvh = Bvh::build(mesh_of(scene), thread_count(options));
  RenderResult result = trace<T>(scene, bvh, options, progress, start);
  const BvhStats& b = bvh.stats();
  result.stats.bvh_seconds = b.seconds;
  result.stats.accel_summary =
      fmt::format("BVH: {} triangles, {} nodes, depth {}, SAH cost {:.1f}, {} bytes, {:.3f} s", b.triangles,
                  b.nodes, b.depth, b.sah_cost, b.bytes, b.seconds);
  return result;
}

}  // namespace

RenderResult render_reference(const Scene& scene, const RenderOptions& options,
                              const ProgressCallback& progress, const Film* start) {
  if (options.epsilon && (scene.unit != 1 || scene.center != Vec3d()))
    return render_reference(in_file_coordinates(scene), options, progress, start);
  const bool wide = options.precision == Precision::float64;
  RenderResult result =
      wide ? trace<double>(scene, options, progress, start) : trace<float>(scene, options, progress, start);
  result.stats.isa = "none";
  result.stats.kernel = wide ? "castRay, double" : "castRay, float";
  return result;
}

}  // namespace castray
