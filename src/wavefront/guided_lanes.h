#pragma once

#include "lights/arrival_guide_lanes.h"
#include "lights/mirrored_lights_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/shading_lanes.h"

// Caustics that the camera sees by way of mirrors and glass are not left to light paths. The camera's paths
// find more of them when a part of their directions leads to where they may come from: to the lights' images
// in flat mirrors, or if there are none, to where light paths came from that arrived nearby.

namespace castray::CASTRAY_ISA {

/// Of directions to where caustics come from: of a pixel's own paths, and of suffixes, whose bright samples
/// all pixels of a tile would show. One vertex of a path has a choice of them, as a rule: each makes the
/// other directions brighter.
inline constexpr float share_of_arrivals = 0.25f, share_of_arrivals_at_suffixes = 0.5f;

/// Which of the vertices i to i + width - 1 have guided directions, how many of these are, and their guide.
struct Guided {
  Mask at;
  Float share;
  MirrorGuide images;
  Uint arrivals;
};

CASTRAY_INLINE Guided guided_at(const Context& c, const Vertices& v, int i, uint32_t vertex) {
  const LightList& lights = c.scene.lights;
  Guided guided{Mask(false), Float(guided_share), {}, Uint(0u)};
  if ((lights.mirrored.count == 0 && !lights.arrivals.tree) || vertex == 0 || !c.left_to_light_paths)
    return guided;
  const Mask active = first_lanes(v.count - i);
  const Uint slot = select(active, load(v.names.slot + i), Uint(0u));
  const Mask kept = gather(c.left_to_light_paths, slot) == Uint(0u);
  guided.at = active & kept & gathers(c.scene, records_of(v, i));
  if (none(guided.at)) return guided;
  if (lights.arrivals.tree) {
    constexpr float no_choice_before = 0.9f;  // such a choice makes eta2 smaller
    guided.at = guided.at & (load(v.eta2 + i) > Float(no_choice_before));
    if (none(guided.at)) return guided;
    guided.arrivals = arrivals_at(lights.arrivals, load(v.p, i));
    guided.share = select(slot < Uint((uint32_t)batch_size), Float(share_of_arrivals),
                          Float(share_of_arrivals_at_suffixes));
    return guided;
  }
  guided.images = guide_to_mirrors(lights.mirrored, load(v.p, i), load(v.normal, i));
  guided.at = guided.at & (guided.images.sum > Float(0.f));
  return guided;
}

/// The pdf of direction wi, where BSDF sampling alone would have `pdf`.
CASTRAY_INLINE Float pdf_with_guide(const Context& c, const Vertices& v, int i, const Guided& guided,
                                    const Vec& wi, Float pdf) {
  if (none(guided.at)) return pdf;
  const LightList& lights = c.scene.lights;
  if (lights.arrivals.tree) {
    const Float by_guide = arrival_pdf(lights.arrivals, guided.arrivals, wi);
    return select(guided.at, fma(guided.share, by_guide, (Float(1.f) - guided.share) * pdf), pdf);
  }
  return select(guided.at, guided_pdf(lights.mirrored, guided.images, load(v.p, i), wi, pdf), pdf);
}

/// A direction of the guide. `choice`, u, v: random numbers.
CASTRAY_INLINE Vec guided_direction(const Context& c, const Vertices& vertices, int i, const Guided& guided,
                                    Float choice, Float u, Float v) {
  const LightList& lights = c.scene.lights;
  if (lights.arrivals.tree) return direction_in(lights.arrivals.cumulative, guided.arrivals, choice, u, v);
  return direction_to_image(lights.mirrored, guided.images, load(vertices.p, i), choice, u, v);
}

/// A direction for each of the vertices i to i + width - 1; as `sample` of their BSDF where none is guided.
CASTRAY_INLINE BsdfSample sample_guided(const Context& c, const Vertices& v, int i, uint32_t vertex,
                                        const Shading& shading, Float lobe, Float u, Float w) {
  const Guided guided = guided_at(c, v, i, vertex);
  if (none(guided.at)) return sample(shading.bsdf, shading.wo, lobe, u, w);
  const Mask by_guide = guided.at & (lobe < guided.share);
  const Float rest = (lobe - guided.share) / (Float(1.f) - guided.share);
  BsdfSample s = sample(shading.bsdf, shading.wo, select(guided.at & ~by_guide, rest, lobe), u, w);
  const Vec wi = guided_direction(c, v, i, guided, lobe / guided.share, u, w);
  s.wi = select(by_guide, to_local(shading.frame, wi), s.wi);
  const BsdfValue value = evaluate(shading.bsdf, shading.wo, s.wi);
  const Float pdf = pdf_with_guide(c, v, i, guided, to_world(shading.frame, s.wi), value.pdf);
  s.weight = select(guided.at, select(pdf > Float(0.f), value.f_cos * (Float(1.f) / pdf), black()), s.weight);
  s.pdf = select(guided.at, pdf, s.pdf);
  s.eta2 = select(guided.at & (value.pdf > Float(0.f)), pdf / value.pdf, s.eta2);
  return s;
}

}  // namespace castray::CASTRAY_ISA
