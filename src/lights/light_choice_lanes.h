#pragma once

#include "lights/light_regions_lanes.h"
#include "simd/vec_lanes.h"

// The choice of a light by what it may bring to a point: Conty Estevez and Kulla 2018, "Importance Sampling
// of Many Lights with Adaptive Tree Splitting", section 3, without splitting; and by what was learned of
// which lights are seen.

namespace castray::CASTRAY_ISA {

/// What a light is chosen for: points within `radius` of p. If one_sided, light arrives on the side of
/// normals whose angle to `normal` has at least this cosine and at most this sine.
struct Receiver {
  Vec p, normal;
  Float radius, cos_spread, sin_spread;
  Mask one_sided;
  const float* seen;  ///< from seen[row] on: what is seen of the cut's nodes; null: not known
  Uint row;
};
CASTRAY_INLINE Receiver receiving_point(const LightRegions& regions, Vec p, Vec normal, Mask one_sided) {
  return {p,
          normal,
          Float(0.f),
          Float(1.f),
          Float(0.f),
          one_sided,
          regions.seen,
          regions.tree ? row_at(regions, fma(normal, Float(light_front), p)) : Uint(0u)};
}

/// A chosen light's number, and its probability; 0 if no light reaches the receiver.
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
CASTRAY_INLINE Bounds gather_bounds(const LightBounds* table, Uint offset) {
  const auto number = [&](float LightBounds::*field) { return gather(table, field, offset); };
  return {gather_vec(table, &LightBounds::center, offset),
          gather_vec(table, &LightBounds::axis, offset),
          number(&LightBounds::radius),
          number(&LightBounds::cos_spread),
          number(&LightBounds::sin_spread),
          number(&LightBounds::power)};
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

/// A chosen node or light, its probability, and a number in [0,1) for the choice within it.
struct Choice {
  Uint next;
  Float probability, u;
};

/// What the cut's nodes are chosen in proportion to, and its sum.
struct CutWeights {
  Float of[most_light_cut], sum;
};

/// Weights for the receiver by importance alone, mixed with such by importance times what is seen of the
/// node. Where importance is not 0, nor is the weight.
CASTRAY_INLINE void mix_in_seen(uint32_t nodes, const Receiver& r, CutWeights& weights) {
  Float seen[most_light_cut], sum(0.f);
  for (uint32_t i = 0; i < nodes; ++i) {
    seen[i] = gather(r.seen, r.row + i);
    sum = sum + weights.of[i] * seen[i];
  }
  const Mask known = (sum > Float(0.f)) & (weights.sum > Float(0.f));
  const Float learned = select(known, Float(learned_share) / sum, Float(0.f));
  const Float by_bounds = select(known, Float(1 - learned_share) / weights.sum, Float(1.f));
  weights.sum = Float(0.f);
  for (uint32_t i = 0; i < nodes; ++i) {
    weights.of[i] = weights.of[i] * fma(seen[i], learned, by_bounds);
    weights.sum = weights.sum + weights.of[i];
  }
}

CASTRAY_INLINE void weigh_cut(const LightList& list, const Receiver& r, CutWeights& weights) {
  weights.sum = Float(0.f);
  for (uint32_t i = 0; i < list.cut_count; ++i) {
    weights.of[i] = importance(broadcast(list.cut[i]), r);
    weights.sum = weights.sum + weights.of[i];
  }
  if (r.seen) mix_in_seen(list.cut_count, r, weights);
}

/// Chooses a node of the cut.
CASTRAY_INLINE Choice choose_in_cut(const LightList& list, Float u, const Receiver& r) {
  CutWeights weights;
  weigh_cut(list, r, weights);
  Float upto[most_light_cut], sum(0.f);
  for (uint32_t i = 0; i < list.cut_count; ++i) upto[i] = sum = sum + weights.of[i];
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

/// Chooses a light: a node of the cut, then a random descent below it. `deep_u` replaces u at the level
/// where its digits are used up.
CASTRAY_INLINE LightChoice choose_by_importance(const LightList& list, Float u, Float deep_u,
                                                const Receiver& r) {
  constexpr int levels_of_u = 6;
  constexpr uint32_t stride = sizeof(LightBounds) / sizeof(float);
  Choice c = choose_in_cut(list, u, r);
  Mask inner = (c.next < Uint(light_leaf)) & (c.probability > Float(0.f));
  for (int level = 0; any(inner); ++level) {
    if (level == levels_of_u) c.u = deep_u;
    const Uint at = select(inner, c.next, Uint(0u)) * (2 * stride);
    const Float a = importance(gather_bounds(list.tree, at), r),
                b = importance(gather_bounds(list.tree, at + Uint(stride)), r);
    const Float inverse = Float(1.f) / max(a + b, Float(0x1p-120f)), p = a * inverse, q = b * inverse;
    const Mask first = c.u < p;
    c.u = select(first, c.u / max(p, Float(0x1p-24f)), (c.u - p) / max(q, Float(0x1p-24f)));
    c.u = max(min(c.u, Float(0x1.fffffep-1f)), Float(0.f));
    c.probability = c.probability * select(inner, select(first, p, q), Float(1.f));
    const Uint child = gather(list.tree, &LightBounds::next, at + select(first, Uint(0u), Uint(stride)));
    c.next = select(inner, child, c.next);
    inner = inner & (child < Uint(light_leaf)) & (c.probability > Float(0.f));
  }
  return {c.next & ~light_leaf, c.probability};
}

/// Inverts the cumulative probabilities at u.
CASTRAY_INLINE Uint choose_by_power(const LightList& list, Float u) {
  Uint low(0u);
  for (uint32_t step = list.count > 1 ? 1u << (31 - __builtin_clz(list.count - 1)) : 0u; step; step >>= 1) {
    const Uint next = low + Uint(step);
    const Mask in_range = next < Uint(list.count);
    const Float start = gather(list.lights, &KernelLight::cumulative,
                               select(in_range, next, Uint(0u)) * uint32_t{light_floats});
    low = select(in_range & (start <= u), next, low);
  }
  return low;
}

/// Chooses a light for the receiver. `deep` replaces u where its digits are used up.
CASTRAY_INLINE LightChoice choose_light(const LightList& list, Float u, Float deep,
                                        const Receiver& receiver) {
  if (list.cut_count > 0) return choose_by_importance(list, u, deep, receiver);
  if (list.count == 1) return {Uint(0u), Float(1.f)};
  const Uint light = choose_by_power(list, u);
  return {light, gather(list.lights, &KernelLight::probability, light * uint32_t{light_floats})};
}

}  // namespace castray::CASTRAY_ISA
