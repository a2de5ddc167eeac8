#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "castray/render_options.h"
#include "lights/area_lights.h"
#include "lights/delta_lights.h"
#include "lights/environment.h"
#include "lights/light_share.h"
#include "materials/coverage.h"
#include "materials/media.h"
#include "reference/camera_sample.h"
#include "reference/estimator.h"
#include "reference/segments.h"
#include "reference/surface.h"
#include "reference/textbook.h"

namespace castray {

/// A scene as castRay sees it; the scene must outlive it.
template <class T>
struct SceneParts {
  explicit SceneParts(const Scene& s) : scene(s), surfaces(s), lights(s), coverage(s), environment(s) {}

  const Scene& scene;
  Surfaces<T> surfaces;
  AreaLights<T> lights;
  Coverage coverage;
  Environment environment;
};

/// The recursive path tracer, line by line the rendering equation (Kajiya 1986)
///
///     L(x, wo) = Le(x, wo) + integral f(x, wo, wi) L(x', -wi) |cos wi| d wi
///
/// whose integral is split in two: light that comes straight from an emitter, sampled over the emitters'
/// areas with d wi = dA cos' / |x' - x|^2, and light reflected at x', sampled by the BSDF. One sample of each
/// per vertex. T is float or double; Accel has `Hit<T> closest(Ray<T>, HitFilter<T>)` and
/// `bool occluded(Ray<T>, HitFilter<T>)`.
template <class T, class Accel>
class CastRay {
 public:
  /// All references must outlive this object. Const and shared by threads.
  CastRay(const SceneParts<T>& parts, const Accel& accel, const Textbook<T>& textbook,
          const RenderOptions& options)
      : scene_(parts.scene),
        surfaces_(parts.surfaces),
        lights_(parts.lights),
        coverage_(parts.coverage),
        environment_(parts.environment),
        accel_(accel),
        textbook_(textbook),
        options_(options),
        filters_(std::ranges::any_of(parts.scene.materials, &Material::filters_maps)),
        segments_{options.epsilon},
        mis_(uses_mis(options.mis, parts.scene, 1)) {}

  /// Radiance of one camera sample of pixel (x,y) of a width x height image; adds the rays traced to `rays`.
  Vec3<T> sample_pixel(int x, int y, int width, int height, std::uint64_t sample, std::uint64_t& rays) const {
    Path path{.key = pixel_key(x, y, options_.seed), .sample = sample};
    path.world = path_world(path.key, sample);
    const std::array<float, 4> u = draw(path, PathBlocks::camera);
    path.light_u = {T(u[2]), T(u[3])};
    const auto lens = [&] { return draw(path, PathBlocks::lens); };
    const CameraRay ray = camera_sample(scene_.camera, x, y, width, height, options_.jitter, u, lens);
    if (filters_) path.pixel = pixel_view<T>(scene_.camera, x, y, width, height, options_.jitter, u, lens);
    const Vec3<T> radiance = cast_ray({Vec3<T>(ray.origin), Vec3<T>(normalize(ray.direction))}, path,
                                      textbook_.camera_sees_emitters() ? Arrival::whole() : Arrival::none());
    rays += path.rays;
    return radiance;
  }

 private:
  /// What the recursion carries along.
  struct Path {
    std::uint32_t key;
    std::uint64_t sample;
    std::uint32_t vertex = 0;
    Vec3<T> throughput{1};  ///< of radiance without the scale of refractions: for roulette only
    Point2<T> light_u{};    ///< for the light point of this vertex
    std::uint64_t rays = 0;
    std::uint32_t world = 0;              ///< what it meets is decided in
    Media media{};                        ///< that the path's last segment is in
    std::optional<PixelView<T>> pixel{};  ///< of the camera's ray, where maps filter
  };

  /// How a ray was sampled, which decides how much of the emission that it hits counts.
  struct Arrival {
    bool counts = false, shared = false;
    T pdf = 0;  ///< where shared, by MIS weight: of the ray's direction, in solid angle
    static Arrival whole() { return {.counts = true}; }
    static Arrival none() { return {}; }
    static Arrival shared_with_lights(T pdf) { return {.counts = true, .shared = true, .pdf = pdf}; }
  };

  std::array<float, 4> draw(const Path& path, std::uint32_t block) const {
    return textbook_.draw(path.key, path.sample, block);
  }

  /// L: radiance that arrives at the ray's origin against its direction (of unit length).
  Vec3<T> cast_ray(const Ray<T>& ray, Path& path, const Arrival& arrival) const {
    ++path.rays;
    const Hit<T> hit = accel_.closest(ray, there(path, ray.direction));
    const Vec3<T> tint = tint_along({ray.origin, ray.direction, hit.found() ? hit.t : endless});
    if (!hit.found()) return escaped(ray.direction, arrival) * kept(path.media, endless) * tint;
    Surface<T> x = surfaces_.at(hit, ray, path.world, path.vertex == 0 ? path.pixel : std::nullopt);
    segments_.place(x, hit, ray);
    if (bounds_body(x) && dot(x.normal, x.to_viewer) < 0) path.media.find(x.material);
    const Vec3<T> transmittance = kept(path.media, hit.t) * tint;
    path.throughput *= transmittance;
    return transmittance * radiance_of(x, path, hit.t, arrival);
  }

  /// L that leaves x to the viewer, at `distance`.
  Vec3<T> radiance_of(const Surface<T>& x, Path& path, T distance, const Arrival& arrival) const {
    Vec3<T> radiance = emission(x, distance, arrival);
    const auto edges_of_next = static_cast<int>(path.vertex) + 2;
    if (options_.max_depth > 0 && edges_of_next > options_.max_depth) return radiance;
    // roulette, lobe, light
    const std::array<float, 4> choice = draw(path, PathBlocks::choice(path.vertex));
    radiance += direct_light(x, path, static_cast<double>(choice[2]) + choice[3] * 0x1p-24);
    radiance += environment_light(x, path);
    radiance += delta_light(x, path);
    const bool clamps = options_.clamp_indirect && path.vertex == 0;
    const Vec3<T> indirect = indirect_light(x, path, T(choice[0]), T(choice[1]));
    return radiance + (clamps ? clamped(indirect, T(*options_.clamp_indirect)) : indirect);
  }

  static constexpr T endless = std::numeric_limits<T>::infinity();

  /// Which hits of a ray count.
  HitFilter<T> there(const Path& path, const Vec3<T>& direction) const {
    return coverage_.there_in(path.world, direction);
  }

  /// What the windows that a ray passes leave of colours: all that it meets, as it ends at what is there.
  Vec3<T> tint_along(const Ray<T>& ray) const {
    Vec3<T> left(1);
    if (!coverage_.tints()) return left;
    const HitFilter<T> pass = [&](const Hit<T>& hit) {
      left *= coverage_.tint(hit, ray.direction);
      return false;
    };
    accel_.occluded(ray, pass);
    return left;
  }

  Vec3<T> kept(const Media& media, T distance) const { return media.transmittance(scene_, distance); }

  bool bounds_body(const Surface<T>& x) const { return scene_.materials[x.material].bounds_body(); }

  /// The media on wi's side of x, where the path arrived through `media`.
  Media beyond(const Surface<T>& x, const Vec3<T>& wi, Media media) const {
    const bool front = dot(x.normal, x.to_viewer) > 0;
    if (!bounds_body(x) || front == (dot(x.normal, wi) > 0)) return media;
    front ? media.enter(x.material) : media.leave();
    return media;
  }

  /// Light from outside, weighted by how the ray was sampled.
  Vec3<T> escaped(const Vec3<T>& direction, const Arrival& arrival) const {
    const Vec3<T> radiance = environment_.radiance(direction);
    if (!environment_.is_sampled()) return radiance;
    if (!arrival.counts) return {};
    return arrival.shared ? radiance * bsdf_share(environment_.pdf(direction), arrival.pdf) : radiance;
  }

  /// Le, weighted by how the ray was sampled.
  Vec3<T> emission(const Surface<T>& x, T distance, const Arrival& arrival) const {
    const Material& material = scene_.materials[x.material];
    const T cosine = dot(x.normal, x.to_viewer);
    if (!arrival.counts || !material.emits_on(cosine > 0)) return {};
    const Vec3<T>& le = x.emission;
    if (!arrival.shared) return le;
    const T light_pdf = lights_.pdf_area(x.material, x.place) * distance * distance / std::abs(cosine);
    return le * bsdf_share(light_pdf, arrival.pdf);
  }

  /// Integral over the emitters' areas, estimated at one point x': f Le cos cos' V / (|x' - x|^2 pdf).
  Vec3<T> direct_light(const Surface<T>& x, Path& path, double u_choice) const {
    if (lights_.empty()) return {};
    const LightPoint<T> y = textbook_.sample_light(lights_, u_choice, path.light_u);
    const Vec3<T> segment = y.p - x.p;
    const T distance2 = dot(segment, segment);
    const Vec3<T> wi = segment / std::sqrt(distance2);
    const Vec3<T> local = x.frame.to_local(wi);
    const T facing = -dot(y.normal, wi), cos_light = y.two_sided ? std::abs(facing) : facing;
    if (!(cos_light > 0) || !x.consistent(wi, local) || in_one_plane(x, y, segment)) return {};

    Vec3<T> radiance = x.bsdf.evaluate(x.wo, local) * y.radiance *
                       (std::abs(local.z) * cos_light / (distance2 * y.pdf_area));
    if (!(max_component(radiance) > 0)) return {};
    if (mis_) radiance *= light_share(y.pdf_area * distance2 / cos_light, x.bsdf.pdf(x.wo, local));
    ++path.rays;
    if (!segments_.visible(accel_, x, y, there(path, segment))) return {};
    return radiance * kept(beyond(x, wi, path.media), std::sqrt(distance2)) *
           tint_along({x.p, segment, T(1)});
  }

  /// Integral over the directions of an image of the environment, estimated in one: f Le |cos| V / pdf.
  Vec3<T> environment_light(const Surface<T>& x, Path& path) const {
    if (!environment_.is_sampled()) return {};
    const std::array<float, 4> u = draw(path, PathBlocks::environment(path.vertex));
    const EnvironmentSample<T> sample = environment_.sample(Point2<T>{T(u[0]), T(u[1])});
    const Vec3<T> local = x.frame.to_local(sample.w);
    if (!(sample.pdf > 0) || !x.consistent(sample.w, local)) return {};
    Vec3<T> radiance = x.bsdf.evaluate(x.wo, local) * sample.radiance * (std::abs(local.z) / sample.pdf);
    if (!(max_component(radiance) > 0)) return {};
    if (mis_) radiance *= light_share(sample.pdf, x.bsdf.pdf(x.wo, local));
    ++path.rays;
    const Ray<T> ray{segments_.origin(x, sample.w), sample.w};
    if (accel_.occluded(ray, there(path, sample.w))) return {};
    return radiance * kept(beyond(x, sample.w, path.media), endless) * tint_along(ray);
  }

  /// The sum over lights without size: f E |cos| V.
  Vec3<T> delta_light(const Surface<T>& x, Path& path) const {
    Vec3<T> sum;
    for (const DeltaLight& light : scene_.delta_lights) {
      const DeltaSample<T> sample = sample_delta(light, x.p);
      const Vec3<T> local = x.frame.to_local(sample.wi);
      if (!x.consistent(sample.wi, local)) continue;
      const Vec3<T> radiance = x.bsdf.evaluate(x.wo, local) * sample.irradiance * std::abs(local.z);
      if (!(max_component(radiance) > 0)) continue;
      ++path.rays;
      const Ray<T> ray{segments_.origin(x, sample.wi), sample.wi, sample.distance};
      if (accel_.occluded(ray, there(path, sample.wi))) continue;
      sum += radiance * kept(beyond(x, sample.wi, path.media), sample.distance) * tint_along(ray);
    }
    return sum;
  }

  /// Integral over all directions of light that is not direct, estimated in one: f |cos| L / pdf.
  Vec3<T> indirect_light(const Surface<T>& x, Path& path, T u_roulette, T u_lobe) const {
    const std::array<float, 4> u = draw(path, PathBlocks::direction(path.vertex));
    const BsdfSample<T> sample = textbook_.sample_bsdf(x.bsdf, x.wo, u_lobe, {T(u[0]), T(u[1])});
    if (!sample.valid()) return sample.weight;
    const Vec3<T> wi = x.frame.to_world(sample.wi);
    if (!x.consistent(wi, sample.wi)) return {};

    path.media = beyond(x, wi, path.media);
    path.throughput *= sample.weight * sample.eta2;
    const T survival = survival_probability(options_.rr, path.vertex, max_component(path.throughput));
    if (!(u_roulette < survival)) return {};
    path.throughput = path.throughput / survival;
    path.light_u = {T(u[2]), T(u[3])};
    ++path.vertex;

    const Arrival arrival = sample.specular ? Arrival::whole()
                            : mis_          ? Arrival::shared_with_lights(sample.pdf)
                                            : Arrival::none();
    return cast_ray({segments_.origin(x, wi), wi}, path, arrival) * (sample.weight / survival);
  }

  static Vec3<T> clamped(const Vec3<T>& radiance, T most) {
    const T brightest = max_component(radiance);
    return brightest > most ? radiance * (most / brightest) : radiance;
  }

  const Scene& scene_;
  const Surfaces<T>& surfaces_;
  const AreaLights<T>& lights_;
  const Coverage& coverage_;
  const Environment& environment_;
  const Accel& accel_;
  const Textbook<T>& textbook_;
  const RenderOptions& options_;
  bool filters_;
  Segments<T> segments_;
  bool mis_;
};

}  // namespace castray
