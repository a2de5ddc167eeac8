#pragma once

#include "materials/bsdf_sample_lanes.h"
#include "materials/material_list.h"

// The BSDF of lanes that may each have another material: every model of the list, where a lane has it.

namespace castray::CASTRAY_ISA {

template <class Model>
CASTRAY_INLINE void evaluate_model(const Bsdf& b, Vec wo, Vec wi, Mask above, BsdfValue& value) {
  const Mask here =
      b.is(Model::type) & Model::has_density(b) & (Model::transmits ? wo.z > Float(0.f) : above);
  if (any(here)) value = choose(here, Model::evaluate(b, wo, wi), value);
}

template <class First, class... Others>
CASTRAY_INLINE BsdfValue evaluate_models(ModelList<First, Others...>, const Bsdf& b, Vec wo, Vec wi) {
  const Mask above = (wi.z > Float(0.f)) & (wo.z > Float(0.f));
  BsdfValue value = choose(b.is(First::type) & above, First::evaluate(b, wo, wi), no_value());
  (evaluate_model<Others>(b, wo, wi, above, value), ...);
  return value;
}

/// f |cos| and density; zero for what a perfectly specular lobe does.
CASTRAY_INLINE BsdfValue evaluate(const Bsdf& b, Vec wo, Vec wi) {
  return evaluate_models(all_models, b, wo, wi);
}

template <class Model>
CASTRAY_INLINE void sample_model(const Bsdf& b, Vec wo, Float choice, Float u, Float v, BsdfSample& s) {
  const Mask here = b.is(Model::type);
  if (any(here)) s = choose(here, Model::sample(b, wo, choice, u, v), s);
}

template <class First, class... Others>
CASTRAY_INLINE BsdfSample sample_models(ModelList<First, Others...>, const Bsdf& b, Vec wo, Float choice,
                                        Float u, Float v) {
  BsdfSample s = First::sample(b, wo, choice, u, v);
  (sample_model<Others>(b, wo, choice, u, v, s), ...);
  return s;
}

/// A direction for the path to go on; `choice` picks the lobe.
CASTRAY_INLINE BsdfSample sample(const Bsdf& b, Vec wo, Float choice, Float u, Float v) {
  BsdfSample s = sample_models(all_models, b, wo, choice, u, v);
  s.weight = select((wo.z > Float(0.f)) & (s.pdf > Float(0.f)), s.weight, black());
  return s;
}

template <class... Models>
CASTRAY_INLINE void finish_values(ModelList<Models...>, const KernelDetail& d, const KernelAlbedo* albedos,
                                  Float* value) {
  ((d.type == Models::type ? Models::finish(d, albedos, value) : void()), ...);
}

}  // namespace castray::CASTRAY_ISA
