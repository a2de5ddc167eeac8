#include "passes/camera_hits.h"

#include "core/sequences.h"
#include "reference/camera_sample.h"

namespace castray {

namespace {

/// Mirrors and panes that are followed, one behind the other; behind so many, nothing is seen.
constexpr std::uint32_t most_mirrors = 16;

/// Whether all that it scatters is in directions that light sampling cannot find.
bool is_mirror(const Material& m) {
  const bool all_smooth = m.type == MaterialType::conductor || m.type == MaterialType::dielectric;
  return all_smooth && (traits_of(m) & trait_specular);
}

Vec3f albedo_of(const Material& m, const SurfaceValues<float>& values) {
  return Vec3f(descriptor_of(m.type).albedo(SurfaceValues<double>(values)));
}

}  // namespace

CameraHits::CameraHits(const Scene& scene, const RenderOptions& options, const Window& window, int threads,
                       bool behind_mirrors)
    : scene_(scene),
      options_(options),
      width_(window.full_width),
      height_(window.full_height),
      follows_(behind_mirrors),
      bvh_(SceneBvh::build(scene, threads)),
      surfaces_(scene),
      coverage_(scene) {
  for (const Material& m : scene.materials) albedos_.push_back(albedo_of(m, SurfaceValues<float>(m)));
}

FirstHit CameraHits::at(int x, int y, std::uint64_t sample) const {
  const std::uint32_t key = pixel_key(x, y, options_.seed);
  const auto draw = [&](std::uint32_t block) { return sample_block(options_.sampler, key, sample, block); };
  const Camera& camera = options_.camera ? *options_.camera : scene_.camera;
  const CameraRay from_camera =
      camera_sample(camera, x, y, width_, height_, options_.jitter, draw(PathBlocks::camera),
                    [&] { return draw(PathBlocks::lens); });
  const std::uint32_t world = path_world(key, sample);
  const Path path{key, sample, world};
  const Ray<float> ray{Vec3f(from_camera.origin), Vec3f(normalize(from_camera.direction))};
  const Hit<float> hit = closest(ray, path);
  if (!hit.found()) return {};
  const Surface<float> x0 = surfaces_.at(hit, ray, world);
  FirstHit first{hit.triangle, appearance(x0, hit), scene_.to_world(Vec3d(x0.p)), 0, {}};
  const Vec3d from_eye = Vec3d(x0.p) - camera.position;
  first.depth = scene_.unit * (camera.projection == Projection::panorama ? length(from_eye)
                                                                         : dot(from_eye, camera.forward));
  if (follows_) first.behind_mirrors = behind_mirrors(x0, hit, path);
  return first;
}

Hit<float> CameraHits::closest(const Ray<float>& ray, const Path& path) const {
  return bvh_.closest(ray, coverage_.there_in(path.world, ray.direction));
}

Vec3f CameraHits::albedo(const Surface<float>& x, const Hit<float>& hit) const {
  const Material& m = scene_.materials[x.material];
  if (!m.has_maps_of_values() && !m.vertex_colors) return albedos_[x.material];
  return albedo_of(m, surface_values(scene_, m, TrianglePlace<float>{hit.triangle, hit.b1, hit.b2}));
}

/// The normal is on the viewer's side.
Appearance CameraHits::appearance(const Surface<float>& x, const Hit<float>& hit) const {
  return {albedo(x, hit), flip_with(x.wo, x.frame.normal)};
}

Appearance CameraHits::behind_mirrors(Surface<float> x, Hit<float> hit, const Path& path) const {
  Vec3f tint(1);
  for (std::uint32_t vertex = 0; is_mirror(scene_.materials[x.material]); ++vertex) {
    const auto draw = [&](std::uint32_t block) {
      return sample_block(options_.sampler, path.key, path.sample, block);
    };
    const float u_lobe = draw(PathBlocks::choice(vertex))[1];
    const BsdfSample<float> sample = x.bsdf.sample(x.wo, u_lobe, {0, 0});
    if (!sample.valid() || vertex == most_mirrors) return {};
    tint *= sample.weight * sample.eta2;
    const Vec3f wi = x.frame.to_world(sample.wi);
    const Ray<float> ray{segments_.origin(x, wi), wi};
    hit = closest(ray, path);
    if (!hit.found()) return {};
    x = surfaces_.at(hit, ray, path.world);
  }
  const Appearance seen = appearance(x, hit);
  return {seen.albedo * tint, seen.normal};
}

}  // namespace castray
