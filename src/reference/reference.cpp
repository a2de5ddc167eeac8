#include "reference/reference.h"

#include <fmt/format.h>

#include "castray/error.h"
#include "core/contract.h"
#include "geometry/flat_slab_list.h"
#include "geometry/list.h"
#include "geometry/scene_bvh.h"
#include "reference/cast_ray.h"
#include "reference/faults.h"

namespace castray {

namespace {

/// The scene in the file's own coordinates, rounded to float: what a path tracer without re-centring works
/// on.
Scene in_file_coordinates(Scene scene) {
  std::vector<bool> moved(scene.positions.size());
  for (std::uint32_t t = 0; t < scene.own_triangles(); ++t)
    for (const std::uint32_t corner : scene.triangles[t])
      if (!moved[corner]) {
        scene.positions[corner] = Vec3f(scene.to_world(Vec3d(scene.positions[corner])));
        moved[corner] = true;
      }
  for (SceneInstance& instance : scene.instances) {
    for (Vec3f& row : instance.rows) row *= static_cast<float>(scene.unit);
    instance.translation = Vec3f(scene.to_world(Vec3d(instance.translation)));
  }
  scene.camera = scene.to_world(scene.camera);
  for (DeltaLight& light : scene.delta_lights) light = scene.to_world(light);
  scene.center = {};
  scene.unit = 1;
  return scene;
}

template <class T>
constexpr const char* kernel_name = sizeof(T) == sizeof(double) ? "castRay, double" : "castRay, float";

template <class T, class Accel>
class Reference final : public PreparedIntegrator {
 public:
  Reference(std::shared_ptr<const Scene> scene, Accel accel)
      : scene_(std::move(scene)), accel_(std::move(accel)), parts_(*scene_) {}

  BandWork work(const Job& job) const override {
    const std::shared_ptr<const Textbook<T>> textbook = make_textbook<T>(job);
    const CastRay<T, Accel> tracer(parts_, accel_, *textbook, job.options);
    return {.render = [tracer, textbook](int y0, int y1, const SampleRange& samples, const SampleMap& map,
                                         Film& film, RowStats& stats) {
      const Window& w = film.window();
      for (int y = y0; y < y1; ++y)
        for (int x = w.x0; x < w.x1; ++x) {
          const auto to = textbook->pixel_of(x, y, w);
          for (std::uint64_t s = samples.first; s < samples.first + samples.count && map.wants(x, y, s);
               ++s) {
            const Vec3<T> radiance = tracer.sample_pixel(x, y, w.full_width, w.full_height, s, stats.rays);
            const Vec3f value = textbook->film_value(Vec3f(radiance));
            if (is_finite(value))
              film.add(to.x, to.y, value);
            else
              stats.nonfinite.push_back({x, y, s});
          }
        }
    }};
  }

  void describe(const Film&, RenderStats& stats) const override {
    stats.isa = "none";
    stats.kernel = kernel_name<T>;
    describe(accel_, stats);
  }

 private:
  void describe(const TriangleList&, RenderStats& stats) const {
    stats.accel_summary = fmt::format("list: {} triangles", scene_->triangles.size());
  }
  void describe(const SceneBvh& bvh, RenderStats& stats) const {
    stats.bvh_seconds = bvh.stats().seconds;
    stats.accel_summary = to_string(bvh.stats());
  }
  void describe(const FlatSlabList<T>&, RenderStats&) const {}

  std::shared_ptr<const Scene> scene_;
  Accel accel_;
  SceneParts<T> parts_;
};

template <class T>
std::unique_ptr<const PreparedIntegrator> prepare(std::shared_ptr<const Scene> scene, const Job& job) {
  const MeshView mesh = mesh_of(*scene);
  if (job.fault == Fault::vanishing_boxes)
    return std::make_unique<Reference<T, FlatSlabList<T>>>(std::move(scene), FlatSlabList<T>(mesh));
  const AccelKind accel = job.options.accel;
  const bool list = accel == AccelKind::list || (accel == AccelKind::automatic && mesh.count <= longest_list);
  if (list && scene->instances.empty())
    return std::make_unique<Reference<T, TriangleList>>(std::move(scene), TriangleList(mesh));
  SceneBvh bvh = SceneBvh::build(*scene, job.threads);
  return std::make_unique<Reference<T, SceneBvh>>(std::move(scene), std::move(bvh));
}

}  // namespace

std::unique_ptr<const PreparedIntegrator> prepare_reference(const Scene& scene, const Job& job) {
  if (job.fault == Fault::vanishing_boxes && !scene.instances.empty())
    throw InputError(scene.file.string() +
                     ": this fault is of a list, which knows no instances; add \"instancing\": \"expand\"");
  const bool classic = job.options.epsilon && (scene.unit != 1 || scene.center != Vec3d());
  const auto traced = classic ? std::make_shared<const Scene>(in_file_coordinates(scene))
                              : std::shared_ptr<const Scene>(std::shared_ptr<void>(), &scene);
  return job.options.precision == Precision::float64 ? prepare<double>(traced, job)
                                                     : prepare<float>(traced, job);
}

}  // namespace castray
