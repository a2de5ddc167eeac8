#include "materials/lobe_albedo.h"

#include <algorithm>

#include "materials/ggx.h"

namespace castray {

namespace {

/// Of quadrature and interpolation. Taken off, so that what is left for the base is never too much.
constexpr double error_bound = 2e-4;

/// The split albedo of light to wo, by the midpoint rule on the unit square of the lobe's own sampling, finer
/// towards u.x = 1 where narrow lobes have their tail. Where wo is at azimuth 0, whose plane makes
/// the lobe its own mirror image, half a turn about the normal will do: `turn` is 0.5, else 1.
LobeAlbedo::Node albedo_at(const Ggx<double>& ggx, const Vec3d& wo, double turn) {
  if (ggx.smooth()) return {1 - schlick_weight(wo.z), 0};
  constexpr int caps = 48;
  const int azimuths = turn < 1 ? 32 : 64;
  const double cap = ggx.cap_scale(wo);
  double a = 0, b = 0;
  for (int i = 0; i < caps; ++i)
    for (int j = 0; j < azimuths; ++j) {
      const double v = 1 - (i + 0.5) / caps;
      const Vec3d h = ggx.sample_normal(wo, {1 - v * v, turn * (j + 0.5) / azimuths}, cap);
      const Vec3d wi = reflect(wo, h);
      if (!(wi.z > 0)) continue;
      const double weight = 2 * v * ggx.reflection_weight(wo, wi, cap), s = schlick_weight(dot(wo, h));
      a += weight * (1 - s);
      b += weight * s;
    }
  const double n = caps * azimuths;
  return {a / n, std::max(1 - a / n - b / n - error_bound, 0.0)};
}

/// The least of all azimuths of wo.
LobeAlbedo::Node least_albedo_at(const Ggx<double>& ggx, double cosine) {
  const double sine = std::sqrt(1 - cosine * cosine);
  if (ggx.aspect == 1) return albedo_at(ggx, {sine, 0, cosine}, 0.5);
  LobeAlbedo::Node least{1, 1};
  constexpr int steps = 2;  // of a quarter of a turn; the others are alike
  for (int i = 0; i <= steps; ++i) {
    const double phi = pi<double> / 2 * i / steps;
    const LobeAlbedo::Node node =
        albedo_at(ggx, {sine * std::cos(phi), sine * std::sin(phi), cosine}, i == 0 ? 0.5 : 1);
    least = {std::min(least.a, node.a), std::min(least.lost, node.lost)};
  }
  return least;
}

double mix(double low, double high, double t) { return low + (high - low) * t; }

}  // namespace

LobeAlbedo::LobeAlbedo(double alpha, double aspect) {
  const Ggx<double> ggx{alpha, true, aspect};
  for (int i = 0; i <= intervals; ++i)
    nodes_[static_cast<std::size_t>(i)] = least_albedo_at(ggx, std::max(cosine<double>(i), 1e-9));
  find_mean();
}

LobeAlbedo::LobeAlbedo(const LobeAlbedo& low, const LobeAlbedo& high, double t) {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    nodes_[i] = {mix(low.nodes_[i].a, high.nodes_[i].a, t), mix(low.nodes_[i].lost, high.nodes_[i].lost, t)};
  find_mean();
}

LobeAlbedo::LobeAlbedo(const LobeAlbedo& one, const LobeAlbedo& other) {
  // What is left is linear in F0: a + lost for 0, and lost for 1.
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node &p = one.nodes_[i], &q = other.nodes_[i];
    const double lost = std::min(p.lost, q.lost);
    nodes_[i] = {std::min(p.a + p.lost, q.a + q.lost) - lost, lost};
  }
  find_mean();
}

LobeAlbedo least_albedo(const LobeWidths& widths) {
  LobeAlbedo least(widths.alpha, widths.aspect);
  if (!widths.to_round) return least;
  constexpr int steps = 3;
  for (int i = 0; i < steps; ++i)
    least = {least, LobeAlbedo(widths.alpha, std::pow(widths.aspect, static_cast<double>(i) / steps))};
  return least;
}

void LobeAlbedo::find_mean() {
  mean_ = {};
  for (int i = 0; i < intervals; ++i) {  // Simpson's rule is exact for c times a linear function
    const double c0 = cosine<double>(i), c1 = cosine<double>(i + 1), middle = (c0 + c1) / 2;
    const Node &low = nodes_[static_cast<std::size_t>(i)], &high = nodes_[static_cast<std::size_t>(i) + 1];
    const auto integral = [&](double at0, double at1) {
      return 2 * (c1 - c0) / 6 * (c0 * at0 + 4 * middle * (at0 + at1) / 2 + c1 * at1);
    };
    mean_.a += integral(low.a, high.a);
    mean_.lost += integral(low.lost, high.lost);
  }
}

const LobeAlbedoRows& LobeAlbedoRows::all() {
  static const LobeAlbedoRows rows;
  return rows;
}

LobeAlbedoRows::LobeAlbedoRows() {
  constexpr int stride = 4;
  static_assert(steps % stride == 0);
  std::vector<LobeAlbedo> computed(steps / stride + 1, LobeAlbedo(0));
#pragma omp parallel for schedule(dynamic)
  for (int i = 1; i <= steps / stride; ++i)
    computed[static_cast<std::size_t>(i)] = LobeAlbedo(alpha_of(i * stride));
  for (int row = 0; row <= steps; ++row) {
    const auto low = static_cast<std::size_t>(std::min(row / stride, steps / stride - 1));
    const double t = static_cast<double>(row) / stride - static_cast<double>(low);
    rows_.emplace_back(computed[low], computed[low + 1], t);
  }
}

Vec3d scattered_again(const Vec3d& mean_fresnel, const LobeAlbedo& lobe) {
  const double lost = lobe.mean().lost, divisor = std::max(lost, double{least_left_for_base});
  const Vec3d again = mean_fresnel * mean_fresnel * (1 - lost) / (Vec3d(1) - mean_fresnel * lost);
  return again / divisor;
}

}  // namespace castray
