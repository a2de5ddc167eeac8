#include "materials/lobe_albedo.h"

#include <algorithm>

#include "materials/ggx.h"

namespace castray {

namespace {

/// Of quadrature and interpolation. Added, so that what is left for the base is never too much.
constexpr double error_bound = 2e-4;

double schlick_weight(double cosine) {
  const double m = 1 - std::min(cosine, 1.0), m2 = m * m;
  return m2 * m2 * m;
}

/// The split albedo at one cosine, by the midpoint rule on the unit square of the lobe's own sampling, finer
/// towards u.x = 1 where narrow lobes have their tail.
LobeAlbedo::Node albedo_at(const Ggx<double>& ggx, double cosine) {
  if (ggx.smooth()) {
    const double s = schlick_weight(cosine);
    return {1 - s, s};
  }
  constexpr int caps = 48, azimuths = 32;  // the integrand is even in the azimuth: half a turn will do
  const Vec3d wo(std::sqrt(1 - cosine * cosine), 0, cosine);
  const double cap = ggx.cap_scale(wo);
  LobeAlbedo::Node sum;
  for (int i = 0; i < caps; ++i)
    for (int j = 0; j < azimuths; ++j) {
      const double v = 1 - (i + 0.5) / caps;
      const Vec3d h = ggx.sample_normal(wo, {1 - v * v, (j + 0.5) / (2 * azimuths)}, cap);
      const Vec3d wi = reflect(wo, h);
      if (!(wi.z > 0)) continue;
      const double weight = 2 * v * ggx.reflection_weight(wo, wi, cap), s = schlick_weight(dot(wo, h));
      sum.a += weight * (1 - s);
      sum.b += weight * s;
    }
  constexpr double n = caps * azimuths;
  return {sum.a / n, sum.b / n};
}

}  // namespace

LobeAlbedo::LobeAlbedo(double alpha) {
  const Ggx<double> ggx{alpha};
  for (int i = 0; i <= intervals; ++i) {
    Node& node = nodes_[static_cast<std::size_t>(i)];
    node = albedo_at(ggx, std::max(cosine<double>(i), 1e-9));
    if (!ggx.smooth()) node.b = std::min(node.b + error_bound, 1 - node.a);
  }
  for (int i = 0; i < intervals; ++i) {  // Simpson's rule is exact for c times a linear function
    const double c0 = cosine<double>(i), c1 = cosine<double>(i + 1), middle = (c0 + c1) / 2;
    const Node &low = nodes_[static_cast<std::size_t>(i)], &high = nodes_[static_cast<std::size_t>(i) + 1];
    const auto integral = [&](double at0, double at1) {
      return 2 * (c1 - c0) / 6 * (c0 * at0 + 4 * middle * (at0 + at1) / 2 + c1 * at1);
    };
    mean_.a += integral(low.a, high.a);
    mean_.b += integral(low.b, high.b);
  }
}

}  // namespace castray
