#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/sequences.h"
#include "materials/material_table.h"
#include "statistics.h"

// Materials for tests of BSDFs, and directions to see them from.

namespace castray::test {

inline Material diffuse() { return {.name = {}, .kd = {0.7, 0.5, 0.3}}; }

inline Material conductor(double alpha) {
  return {.name = {}, .type = MaterialType::conductor, .reflectance = {1, 0.8, 0.4}, .alpha = alpha};
}

/// Whose lobe is not round.
inline Material brushed(double alpha) {
  Material metal = conductor(alpha);
  metal.anisotropy = 0.8;
  return metal;
}

/// By an index, and with what its facets reflect more than once.
inline Material rough_gold(double alpha) {
  Material gold = conductor(alpha);
  gold.eta = {0.16, 0.42, 1.38}, gold.k = {4, 2.04, 1.74};
  gold.multiple_scattering = true;
  return gold;
}

inline Material microfacet(double alpha, double kd = 0.5, double ks = 0.3) {
  return {
      .name = {}, .type = MaterialType::microfacet, .kd = Vec3d(kd), .ks = {ks, ks, ks / 2}, .alpha = alpha};
}

/// Metal, coated base, sheen and clear coat, some of each.
inline Material principled(double alpha, double kd = 0.5) {
  return {.name = {},
          .type = MaterialType::principled,
          .kd = {kd, kd, kd / 2},
          .ks = Vec3d(0.1),
          .alpha = alpha,
          .metallic = 0.3,
          .sheen = 0.8,
          .clearcoat = 0.6,
          .clearcoat_roughness = 0.5};
}

inline Material dielectric(double alpha, double ior = 1.5) {
  return {.name = {}, .type = MaterialType::dielectric, .alpha = alpha, .ior = ior};
}

template <class T>
Vec3<T> direction(T theta, T phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Viewing directions on both sides, from the normal to grazing.
template <class T>
std::vector<Vec3<T>> viewers() {
  return {direction(T(0.05), T(0.3)), direction(T(0.8), T(2)), direction(T(1.45), T(4)),
          direction(T(2.2), T(1))};
}

template <class T>
BsdfSample<T> draw(const Bsdf<T>& bsdf, const Vec3<T>& wo, std::uint32_t key, std::uint64_t i) {
  const auto u = sample_block(SamplerKind::independent, key, i, 0);
  return bsdf.sample(wo, T(u[2]), {T(u[0]), T(u[1])});
}

/// Integral of f |cos| over the hemisphere, by quadrature in the angles about the normal: wo is at azimuth 0,
/// the lobe about azimuth pi, where at grazing angles it is narrow.
inline Vec3d albedo_by_quadrature(const Bsdf<double>& bsdf, double theta_o) {
  static const GaussRule rule(160);
  const Vec3d wo = direction(theta_o, 0.0);
  Vec3d sum;
  for (std::size_t i = 0; i < rule.x.size(); ++i)
    for (std::size_t j = 0; j < rule.x.size(); ++j) {
      const double theta = rule.x[i] * pi<double> / 2, phi = pi<double> * (1 - rule.x[j] * rule.x[j]);
      const Vec3d wi = direction(theta, phi);
      sum += bsdf.evaluate(wo, wi) * (rule.w[i] * rule.w[j] * 2 * rule.x[j] * std::sin(theta) * wi.z);
    }
  return sum * (pi<double> / 2 * 2 * pi<double>);
}

/// The mean weight of samples, by a (0,2)-sequence.
inline double albedo_of_white(const Bsdf<double>& bsdf, const Vec3d& wo) {
  constexpr std::uint64_t n = 4096;
  double sum = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto u = sample_block(SamplerKind::sobol, 11, i, 0);
    sum += bsdf.sample(wo, u[2], {u[0], u[1]}).weight.x;
  }
  return sum / n;
}

}  // namespace castray::test
