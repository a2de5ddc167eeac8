#include "wavefront/edge_emission.h"

#include "core/sequences.h"
#include "geometry/ray_arrays.h"
#include "wavefront/host_rays.h"

namespace castray {

namespace {

constexpr std::uint64_t rays_of_a_sample = 8;

}  // namespace

EdgeEmission::EdgeEmission(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data,
                           const Window& window, const RenderOptions& options)
    : scene_(scene),
      kernel_(kernel),
      data_(data),
      width_(window.full_width),
      height_(window.full_height),
      sampler_(options.sampler),
      seed_(options.seed),
      known_(options.jitter && !scene.environment_image.used() && !data.view.lights.materials &&
             !data.coverage.partial_triangles()) {}

Vec3f EdgeEmission::at(int x, int y, std::uint64_t sample) const {
  constexpr std::uint32_t of_edges = 0xed6e5u;
  const std::uint32_t key = hash_combine(pixel_key(x, y, seed_), of_edges);
  RayArrays rays;
  for (std::uint64_t i = 0; i < rays_of_a_sample; ++i) {
    const auto u = sample_block(sampler_, key, sample * rays_of_a_sample + i, 0);
    const CameraRay ray =
        scene_.camera.ray(x + double{u[0]}, y + double{u[1]}, width_, height_, double{u[2]}, double{u[3]});
    rays.add({Vec3f(ray.origin), Vec3f(normalize(ray.direction))});
  }
  Hit<float> hits[rays_of_a_sample];
  rays.closest([&](const RayBatch& b) { closest_hits(kernel_, data_, true, b); }, 0, rays.size(), hits);
  Vec3f sum;
  for (std::size_t i = 0; i < rays_of_a_sample; ++i) sum += emission(hits[i], rays[i].direction);
  return sum / static_cast<float>(rays_of_a_sample);
}

Vec3f EdgeEmission::emission(const Hit<float>& hit, const Vec3f& direction) const {
  if (!hit.found()) return Vec3f(scene_.environment);
  const auto [normal, material] = surface_hit(scene_, data_, hit);
  const bool front = dot(normal, direction) < 0;
  const Material& m = scene_.materials[scene_.on_side(static_cast<std::uint16_t>(material), front)];
  return m.emits_on(front) ? Vec3f(m.ke) : Vec3f();
}

}  // namespace castray
