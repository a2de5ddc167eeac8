#include "wavefront/try_lights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/frame.h"
#include "core/sequences.h"
#include "core/warp.h"
#include "geometry/ray_arrays.h"
#include "wavefront/host_rays.h"

namespace castray {

namespace {

/// Of the paths, at most; of a batch of them; vertices of a path, and nodes looked for at each, at most.
constexpr int most_paths = 2048, fewest_paths = 256, pixels_of_a_path = 8, batch = 256;
constexpr std::uint32_t vertices = 4, tests = 8;

constexpr std::uint32_t key = 0x11647;

/// Panes between a place and a light, at most; behind more, the light is taken for hidden.
constexpr int most_windows = 4;

/// Where rays start, off the surface: coarser than in an image, which no trial is part of.
constexpr float offset = 0x1p-14f;

double fraction(double x) { return x - std::floor(x); }

using Rays = std::vector<Ray<float>>;

/// A vertex of path number `path`.
struct Vertex {
  Vec3f p, normal, direction;  ///< of the ray's side; of the ray
  std::uint32_t path;
  bool transmits;
};

/// One batch of paths and the trials at their vertices.
class Batch {
 public:
  Batch(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data,
        const std::vector<double>& power_shares)
      : scene_(scene), kernel_(kernel), data_(data), power_shares_(power_shares) {
    for (std::size_t node = 0; node <= power_shares.size(); ++node)
      first_of_.push_back(data.lights.first_of(node));
  }

  std::vector<LightTrial> run(int first, int paths, int width, int height) {
    std::vector<LightTrial> trials;
    Rays rays = camera_rays(first, paths, width, height);
    for (std::uint32_t depth = 0; depth < vertices && !rays.empty(); ++depth) {
      const std::vector<Vertex> hits = find_vertices(rays, depth == 0);
      look_for_lights(hits, depth, trials);
      rays = scatter(hits, depth);
    }
    return trials;
  }

 private:
  Rays camera_rays(int first, int paths, int width, int height) {
    Rays rays;
    names_.clear();
    for (int i = first; i < std::min(first + batch, paths); ++i) {
      constexpr double golden = 0.6180339887498949;
      const CameraRay ray = scene_.camera.ray((i + 0.5) / paths * width,
                                              fraction((i + 0.5) * golden) * height, width, height, 0, 0);
      rays.push_back({Vec3f(ray.origin), Vec3f(normalize(ray.direction))});
      names_.push_back(static_cast<std::uint32_t>(i));
    }
    return rays;
  }

  std::vector<Vertex> find_vertices(const Rays& rays, bool from_camera) {
    std::vector<Hit<float>> hits(rays.size());
    RayArrays(rays).closest([&](const RayBatch& b) { closest_hits(kernel_, data_, from_camera, b); }, 0,
                            rays.size(), hits.data());
    std::vector<Vertex> found;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!hits[i].found()) continue;
      const auto [normal, material] = surface_hit(scene_, data_, hits[i]);
      const Vec3f facing = dot(normal, rays[i].direction) < 0 ? normal : -normal;
      found.push_back({rays[i].origin + rays[i].direction * hits[i].t + facing * offset, facing,
                       rays[i].direction, names_[i],
                       (data_.materials.materials[material].traits & trait_transmits) != 0});
    }
    return found;
  }

  void look_for_lights(const std::vector<Vertex>& at, std::uint32_t depth, std::vector<LightTrial>& trials) {
    Rays segments;
    std::vector<std::pair<std::size_t, std::uint32_t>> asked;  // trial and node
    for (const Vertex& x : at) {
      LightTrial trial{x.p + x.normal * light_front};
      std::array<Ray<float>, most_light_cut> segment;
      const auto u = sample_block(SamplerKind::sobol, key + 1, x.path, depth);
      for (std::size_t node = 0; node < power_shares_.size(); ++node)
        trial.potential[node] = aim(x, node, u, segment[node]);
      for (const std::uint32_t node : nodes_to_test(trial, u[3])) {
        trial.tested |= 1u << node;
        segments.push_back(segment[node]);
        asked.emplace_back(trials.size(), node);
      }
      if (trial.tested) trials.push_back(trial);
    }
    std::vector<std::uint8_t> hidden(segments.size());
    RayArrays(segments).occluded([&](const ShadowBatch& b) { occluded_segments(kernel_, data_, b); }, 0,
                                 segments.size(), hidden.data());
    if (has_windows_) see_through_windows(std::move(segments), hidden);
    for (std::size_t i = 0; i < asked.size(); ++i)
      if (!hidden[i]) trials[asked[i].first].seen |= 1u << asked[i].second;
  }

  /// Segments on which only windows lie are not hidden.
  void see_through_windows(Rays segments, std::vector<std::uint8_t>& hidden) const {
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < hidden.size(); ++i)
      if (hidden[i]) left.push_back(i);
    for (int windows = 0; windows <= most_windows && !left.empty(); ++windows) {
      Rays rays;
      for (const std::size_t i : left) rays.push_back(segments[i]);
      std::vector<Hit<float>> hits(rays.size());
      RayArrays(rays).closest([&](const RayBatch& b) { closest_hits(kernel_, data_, false, b); }, 0,
                              rays.size(), hits.data());
      std::vector<std::size_t> behind;
      for (std::size_t k = 0; k < left.size(); ++k) {
        Ray<float>& segment = segments[left[k]];
        if (!hits[k].found())
          hidden[left[k]] = 0;
        else if (scene_.material_of(hits[k].triangle).is_window()) {
          const float past = hits[k].t + offset / length(segment.direction);
          segment.origin = segment.origin + segment.direction * past;
          segment.t_max -= past;
          behind.push_back(left[k]);
        }
      }
      left = std::move(behind);
    }
  }

  /// Some of those that may light the place, from a random one on.
  static std::vector<std::uint32_t> nodes_to_test(const LightTrial& trial, float u) {
    constexpr std::uint32_t nodes = most_light_cut, stride = 13;  // which have no factor in common
    std::vector<std::uint32_t> chosen;
    std::uint32_t node = static_cast<std::uint32_t>(u * nodes);
    for (std::uint32_t k = 0; k < nodes && chosen.size() < tests; ++k, node = (node + stride) % nodes)
      if (trial.potential[node] > 0) chosen.push_back(node);
    return chosen;
  }

  /// The segment from x to a point of a node, and the node's irradiance by it, were nothing between.
  float aim(const Vertex& x, std::size_t node, const std::array<float, 4>& u, Ray<float>& segment) const {
    const auto shift = [&](std::size_t d, double by) {
      return fraction(u[d] + static_cast<double>(node) * by);
    };
    const KernelLight& l = light_of(node, shift(2, 0.5698402909980532));
    double a = shift(0, 0.8191725133961645), b = shift(1, 0.6710436067037893);
    if (l.triangle && a + b > 1) a = 1 - a, b = 1 - b;
    Vec3f p, normal(l.normal[0], l.normal[1], l.normal[2]);
    for (int c = 0; c < 3; ++c)
      p[c] = l.origin[c] + static_cast<float>(a) * l.edge1[c] + static_cast<float>(b) * l.edge2[c];
    const Vec3f to = p - x.p;
    if (l.two_sided && dot(normal, to) > 0) normal = -normal;
    const float distance2 = std::max(dot(to, to), 1e-12f), facing = -dot(normal, to);
    const float arriving = x.transmits ? std::abs(dot(x.normal, to)) : dot(x.normal, to);
    segment = {x.p, p + normal * offset - x.p, 1.f};
    if (!(facing > 0) || !(arriving > 0)) return 0;
    return static_cast<float>(power_shares_[node]) / static_cast<float>(l.two_sided ? 2 : 1) * facing *
           arriving / (distance2 * distance2);
  }

  /// A light of the node, by power.
  const KernelLight& light_of(std::size_t node, double u) const {
    const auto begin = data_.lights.lights().begin();
    const auto first = begin + first_of_[node], last = begin + first_of_[node + 1];
    const double target = double{first->cumulative} + u * power_shares_[node];
    const auto after = std::upper_bound(
        first + 1, last, target, [](double t, const KernelLight& l) { return t < double{l.cumulative}; });
    return *(after - 1);
  }

  Rays scatter(const std::vector<Vertex>& from, std::uint32_t depth) {
    Rays rays;
    names_.clear();
    for (const Vertex& x : from) {
      const auto u = sample_block(SamplerKind::sobol, key, x.path, depth);
      if (x.transmits)
        rays.push_back({x.p - x.normal * (2 * offset), x.direction});
      else
        rays.push_back({x.p, make_frame(x.normal).to_world(cosine_hemisphere(Point2<float>{u[0], u[1]}))});
      names_.push_back(x.path);
    }
    return rays;
  }

  const Scene& scene_;
  const KernelApi& kernel_;
  const KernelSceneData& data_;
  const std::vector<double>& power_shares_;
  bool has_windows_ = std::ranges::any_of(scene_.materials, &Material::is_window);
  std::vector<std::uint32_t> first_of_;
  std::vector<std::uint32_t> names_;  ///< of the paths of the present rays
};

}  // namespace

std::vector<LightTrial> try_lights(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data,
                                   int width, int height, int threads) {
  const int paths = std::clamp(width * height / pixels_of_a_path, fewest_paths, most_paths);
  const int batches = (paths + batch - 1) / batch;
  const std::vector<double> power_shares = data.lights.power_shares();
  std::vector<std::vector<LightTrial>> parts(static_cast<std::size_t>(batches));
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (int i = 0; i < batches; ++i)
    parts[static_cast<std::size_t>(i)] =
        Batch(scene, kernel, data, power_shares).run(i * batch, paths, width, height);
  std::vector<LightTrial> trials;
  for (const auto& part : parts) trials.insert(trials.end(), part.begin(), part.end());
  return trials;
}

}  // namespace castray
