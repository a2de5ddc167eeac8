#pragma once

#include "lights/light_records.h"
#include "simd/angles_lanes.h"
#include "simd/vec_lanes.h"

// lights/environment.h in lanes.

namespace castray::CASTRAY_ISA {

/// Light from outside the scene, from direction w.
struct EscapedLight {
  Vec radiance;
  Float density;  ///< pdf of the direction by light sampling, per solid angle; 0: it is found by such rays
                  ///< alone
};

/// A direction to the environment.
struct EnvironmentSample {
  Vec w;
  EscapedLight light;
};

/// The light of texels, seen at an angle with this sine from the poles.
CASTRAY_INLINE EscapedLight texel_light(const EnvironmentTable& e, Uint column, Uint row, Float sine) {
  const Uint texel = row * e.width + column, in_row = row * (e.width + 1) + column;
  const Float probability = (gather(e.rows + 1, row) - gather(e.rows, row)) *
                            (gather(e.columns + 1, in_row) - gather(e.columns, in_row));
  const Float texels_per_angle((float)e.width * (float)e.height / (2 * pi * pi));
  return {gather_vec(e.radiance, texel * 3u),
          select(sine > Float(0.f), probability * texels_per_angle / sine, Float(0.f))};
}

/// w need not be of unit length.
CASTRAY_INLINE EscapedLight light_from(const EnvironmentTable& e, const Vec& w) {
  if (e.width == 0) return {broadcast(e.constant), Float(0.f)};
  const auto cell = [](Float at, uint32_t count) {
    return to_uint(min(at * Float((float)count), Float((float)(count - 1))));
  };
  const Float across = sqrt(fma(w.x, w.x, w.z * w.z));
  const Float turn = turn_of(w.x, -w.z) + Float(e.turn);
  const Float column = select(turn >= Float(1.f), turn - Float(1.f), turn);
  const Float row = turn_of(across, w.y) * Float(2.f);
  return texel_light(e, cell(column, e.width), cell(row, e.height), across / sqrt(length_squared(w)));
}

/// Where u falls among `count` cumulative probabilities: the number of the last that is at most u, and how
/// far u is on the way to the next.
struct Interval {
  Uint index;
  Float fraction;
};
CASTRAY_INLINE Interval find_interval(const float* cumulative, Uint first, uint32_t count, Float u) {
  Uint low(0u);
  for (uint32_t step = count > 1 ? 1u << (31 - __builtin_clz(count - 1)) : 0u; step; step >>= 1) {
    const Uint next = low + Uint(step);
    const Mask in_range = next < Uint(count);
    const Float start = gather(cumulative, first + select(in_range, next, Uint(0u)));
    low = select(in_range & (start <= u), next, low);
  }
  const Float start = gather(cumulative, first + low), end = gather(cumulative + 1, first + low);
  return {low, (u - start) / (end - start)};
}

/// Only where it is an image.
CASTRAY_INLINE EnvironmentSample sample_environment(const EnvironmentTable& e, Float u, Float v) {
  const Interval row = find_interval(e.rows, Uint(0u), e.height, v);
  const Interval column = find_interval(e.columns, row.index * (e.width + 1), e.width, u);
  const auto place = [](const Interval& i, uint32_t count) {
    return min((to_float(i.index) + i.fraction) * Float(1.f / (float)count), Float(1.f));
  };
  const Float turn = place(column, e.width) - Float(e.turn);
  const SinCos theta = sincos_turn(place(row, e.height) * Float(0.5f));
  const SinCos phi = sincos_turn(select(turn < Float(0.f), turn + Float(1.f), turn));
  return {{theta.sin * phi.sin, theta.cos, -(theta.sin * phi.cos)},
          texel_light(e, column.index, row.index, theta.sin)};
}

}  // namespace castray::CASTRAY_ISA
