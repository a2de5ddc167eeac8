#include "lights/light_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "castray/vec.h"

namespace castray {

namespace {

Vec3d to_vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

/// The unit directions within `half_angle` of `axis`.
struct Cone {
  Vec3d axis;
  double half_angle;
};

Cone whole_sphere(const Vec3d& axis) { return {axis, std::numbers::pi}; }

Cone cone_of(const LightBounds& b) {
  if (b.cos_spread <= 0) return whole_sphere(to_vec(b.axis));
  return {to_vec(b.axis), std::acos(std::min<double>(b.cos_spread, 1))};
}

/// A cone around both (Conty Estevez and Kulla 2018, algorithm 1).
Cone join(Cone a, Cone b) {
  if (b.half_angle > a.half_angle) std::swap(a, b);
  const double between = std::acos(std::clamp(dot(a.axis, b.axis), -1.0, 1.0));
  if (std::min(between + b.half_angle, std::numbers::pi) <= a.half_angle) return a;
  const double half_angle = (a.half_angle + between + b.half_angle) / 2;
  const Vec3d across = b.axis - a.axis * dot(a.axis, b.axis);
  if (half_angle >= std::numbers::pi || !(length(across) > 1e-6)) return whole_sphere(a.axis);
  const double turn = half_angle - a.half_angle;
  return {normalize(a.axis * std::cos(turn) + normalize(across) * std::sin(turn)), half_angle};
}

/// Rounded outward.
void put(LightBounds& b, const Vec3d& center, double radius, const Cone& cone) {
  constexpr double margin = 1e-6;
  const double half_angle = std::min(cone.half_angle, std::numbers::pi / 2);
  for (int i = 0; i < 3; ++i) {
    b.center[i] = static_cast<float>(center[i]);
    b.axis[i] = static_cast<float>(cone.axis[i]);
  }
  b.radius = static_cast<float>(radius * (1 + margin) + margin * margin);
  b.cos_spread = static_cast<float>(std::max(std::cos(half_angle) - margin, 0.0));
  b.sin_spread = static_cast<float>(std::min(std::sin(half_angle) + margin, 1.0));
}

LightBounds bounds_of(const KernelLight& light) {
  const Vec3d origin = to_vec(light.origin), edge1 = to_vec(light.edge1), edge2 = to_vec(light.edge2);
  const Vec3d center = origin + (edge1 + edge2) * (light.triangle ? 1.0 / 3 : 0.5);
  double radius =
      std::max({length(origin - center), length(origin + edge1 - center), length(origin + edge2 - center)});
  if (!light.triangle) radius = std::max(radius, length(origin + edge1 + edge2 - center));
  const Vec3d normal = to_vec(light.normal);
  LightBounds b{};
  put(b, center, radius, light.two_sided ? whole_sphere(normal) : Cone{normal, 0});
  b.power = static_cast<float>(luminance(to_vec(light.emission)) * light.area);
  return b;
}

/// The sphere around two spheres.
void join_spheres(const LightBounds& a, const LightBounds& b, Vec3d& center, double& radius) {
  const Vec3d between = to_vec(b.center) - to_vec(a.center);
  const double distance = length(between);
  center = to_vec(a.center);
  radius = std::max<double>(a.radius, distance + b.radius);
  if (distance + a.radius <= b.radius) {
    center = to_vec(b.center);
    radius = b.radius;
  } else if (distance + b.radius > a.radius) {
    radius = (distance + a.radius + b.radius) / 2;
    center += between * ((radius - a.radius) / distance);
  }
}

LightBounds join(const LightBounds& a, const LightBounds& b) {
  LightBounds both{};
  Vec3d center;
  double radius;
  join_spheres(a, b, center, radius);
  put(both, center, radius, join(cone_of(a), cone_of(b)));
  both.power = a.power + b.power;
  return both;
}

class Builder {
 public:
  Builder(const std::vector<KernelLight>& lights, std::vector<LightBounds>& pairs)
      : lights_(lights), pairs_(pairs) {}

  /// The node of lights [first, last), the inner nodes below which are pairs from `pair` on: one less than
  /// the lights.
  LightBounds build(std::uint32_t first, std::uint32_t last, std::uint32_t pair) {
    if (last - first == 1) {
      LightBounds leaf = bounds_of(lights_[first]);
      leaf.next = light_leaf + first;
      return leaf;
    }
    const std::uint32_t middle = first + (last - first) / 2;
    LightBounds a, b;
    constexpr std::uint32_t worth_a_task = 4096;
#pragma omp task shared(a) if (last - first > worth_a_task)
    a = build(first, middle, pair + 1);
    b = build(middle, last, pair + (middle - first));
#pragma omp taskwait
    pairs_[2 * pair] = a;
    pairs_[2 * pair + 1] = b;
    LightBounds both = join(a, b);
    both.next = pair;
    return both;
  }

 private:
  const std::vector<KernelLight>& lights_;
  std::vector<LightBounds>& pairs_;
};

bool is_leaf(const LightBounds& b) { return b.next >= light_leaf; }

}  // namespace

LightTree::LightTree(const std::vector<KernelLight>& lights, int threads) {
  if (lights.empty()) return;
  pairs_.resize(2 * (lights.size() - 1));
  cut_.resize(1);
#pragma omp parallel num_threads(threads)
#pragma omp single
  cut_[0] = Builder(lights, pairs_).build(0, static_cast<std::uint32_t>(lights.size()), 0);
  while (2 * cut_.size() <= most_light_cut && !std::ranges::all_of(cut_, is_leaf)) {
    std::vector<LightBounds> next_level;
    for (const LightBounds& node : cut_) {
      if (is_leaf(node)) {
        next_level.push_back(node);
      } else {
        next_level.insert(next_level.end(), &pairs_[2 * node.next], &pairs_[2 * node.next] + 2);
      }
    }
    cut_ = next_level;
  }
}

}  // namespace castray
