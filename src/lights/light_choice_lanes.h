#pragma once

#include "simd/vec_lanes.h"
#include "wavefront/kernel_api.h"

// The choice of a light by what it may bring to a point: Conty Estevez and Kulla 2018, "Importance Sampling
// of Many Lights with Adaptive Tree Splitting", section 3, without splitting.

namespace castray::CASTRAY_ISA {

/// Where light is to arrive: within `radius` of p, and where one-sided, on the side of some unit normal whose
/// angle to `normal` has at least this cosine and at most this sine.
struct Receiver {
  Vec p, normal;
  Float radius, cos_spread, sin_spread;
  Mask one_sided;
};
CASTRAY_INLINE Receiver receiving_point(Vec p, Vec normal, Mask one_sided) {
  return {p, normal, Float(0.f), Float(1.f), Float(0.f), one_sided};
}

/// A chosen light: its number, and the probability of that; 0 if no light can reach the receiver.
struct LightChoice {
  Uint light;
  Float probability;
};

/// LightBounds in each lane.
struct Bounds {
  Vec center, axis;
  Float radius, cos_spread, sin_spread, power;
};
CASTRAY_INLINE Bounds broadcast(const LightBounds& b) {
  return {broadcast(b.center), broadcast(b.axis),   Float(b.radius),
          Float(b.cos_spread), Float(b.sin_spread), Float(b.power)};
}
CASTRAY_INLINE Bounds gather_bounds(const LightBounds& first, Uint offset) {
  return {gather_vec(first.center, offset),  gather_vec(first.axis, offset),    gather(&first.radius, offset),
          gather(&first.cos_spread, offset), gather(&first.sin_spread, offset), gather(&first.power, offset)};
}

/// Proportional to a bound of the light that may arrive; never 0 where some may, whatever the rounding.
///
/// Instead of angles it has bounds of their cosines, which need no square roots. With x the sine of the angle
/// in which the positions are uncertain, cos(a - b) <= cos a + x + x^2 for b up to asin(x); and for normals
/// within s <= 90 degrees of the axis, cos(a - s) <= cos a cos s + sin s.
CASTRAY_INLINE Float importance(const Bounds& b, const Receiver& r) {
  const Vec d = b.center - r.p;
  const Float inverse = Float(1.f) / sqrt(max(length_squared(d), max(b.radius * b.radius, Float(0x1p-100f))));
  const Float x = (b.radius + r.radius) * inverse, uncertain = fma(x, x, x);
  const auto bound = [&](Float along_axis, Float cos_spread, Float sin_spread) {
    constexpr float margin = 0x1p-10f;
    const Float most = min(fma(along_axis, inverse, uncertain), Float(1.f));
    return min(max(fma(most, cos_spread, sin_spread + Float(margin)), Float(0.f)), Float(1.f));
  };
  const Float leaving = bound(-dot(b.axis, d), b.cos_spread, b.sin_spread);
  const Float arriving = select(r.one_sided, bound(dot(r.normal, d), r.cos_spread, r.sin_spread), Float(1.f));
  return b.power * leaving * arriving * inverse * inverse;
}

/// Something chosen: what it is, with which probability, and a number in [0,1) to choose by what is in it.
struct Choice {
  Uint next;
  Float probability, u;
};

/// One node of the cut, looking at every one.
CASTRAY_INLINE Choice choose_in_cut(const LightList& list, Float u, const Receiver& r) {
  Float upto[most_light_cut];
  Float sum(0.f);
  for (uint32_t i = 0; i < list.cut_count; ++i) upto[i] = sum = sum + importance(broadcast(list.cut[i]), r);
  const Float at = u * sum;
  Uint next(list.cut[0].next);
  Float before(0.f), after = upto[0];
  for (uint32_t i = 1; i < list.cut_count; ++i) {
    const Mask beyond = (upto[i - 1] <= at) & (upto[i - 1] < upto[i]);
    next = select(beyond, Uint(list.cut[i].next), next);
    before = select(beyond, upto[i - 1], before);
    after = select(beyond, upto[i], after);
  }
  const Mask any_light = sum > Float(0.f);
  const Float chosen = after - before;
  return {next, select(any_light, chosen / sum, Float(0.f)),
          select(any_light, (at - before) / chosen, Float(0.f))};
}

/// A light: a node of the cut, then a descent by chance below it. `deep_u` serves below the levels that use u
/// up.
CASTRAY_INLINE LightChoice choose_by_importance(const LightList& list, Float u, Float deep_u,
                                                const Receiver& r) {
  constexpr int levels_of_u = 6;
  constexpr uint32_t stride = sizeof(LightBounds) / sizeof(float);
  Choice c = choose_in_cut(list, u, r);
  Mask inner = (c.next < Uint(light_leaf)) & (c.probability > Float(0.f));
  for (int level = 0; any(inner); ++level) {
    if (level == levels_of_u) c.u = deep_u;
    const Uint at = select(inner, c.next, Uint(0u)) * (2 * stride);
    const Float a = importance(gather_bounds(*list.tree, at), r),
                b = importance(gather_bounds(*list.tree, at + Uint(stride)), r);
    const Float inverse = Float(1.f) / max(a + b, Float(0x1p-120f)), p = a * inverse, q = b * inverse;
    const Mask first = c.u < p;
    c.u = select(first, c.u / max(p, Float(0x1p-24f)), (c.u - p) / max(q, Float(0x1p-24f)));
    c.u = max(min(c.u, Float(0x1.fffffep-1f)), Float(0.f));
    c.probability = c.probability * select(inner, select(first, p, q), Float(1.f));
    const Uint child = gather(&list.tree->next, at + select(first, Uint(0u), Uint(stride)));
    c.next = select(inner, child, c.next);
    inner = inner & (child < Uint(light_leaf)) & (c.probability > Float(0.f));
  }
  return {c.next & ~light_leaf, c.probability};
}

}  // namespace castray::CASTRAY_ISA
