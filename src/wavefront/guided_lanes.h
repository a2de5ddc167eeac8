#pragma once

#include "lights/mirrored_lights_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/shading_lanes.h"

// Caustics that the camera sees by way of mirrors are not left to light paths. Of those that flat mirrors
// make the camera's paths find more when a part of their directions leads to the lights' images in them.

namespace castray::CASTRAY_ISA {

/// Which of the vertices i to i + width - 1 have guided directions, and their guide.
struct Guided {
  Mask at;
  MirrorGuide guide;
};

CASTRAY_INLINE Guided guided_at(const Context& c, const Vertices& v, int i, uint32_t vertex) {
  const MirroredLightList& images = c.scene.lights.mirrored;
  Guided guided{Mask(false), {}};
  if (images.count == 0 || vertex == 0 || !c.left_to_light_paths) return guided;
  const Mask active = first_lanes(v.count - i);
  const Uint slot = select(active, load(v.names.slot + i), Uint(0u));
  const Mask kept = gather(c.left_to_light_paths, slot) == Uint(0u);
  guided.at = active & kept & gathers(c.scene, records_of(v, i));
  if (none(guided.at)) return guided;
  guided.guide = guide_to_mirrors(images, load(v.p, i), load(v.normal, i));
  guided.at = guided.at & (guided.guide.sum > Float(0.f));
  return guided;
}

/// The pdf of direction wi, where BSDF sampling alone would have `pdf`.
CASTRAY_INLINE Float pdf_with_guide(const Context& c, const Vertices& v, int i, const Guided& guided,
                                    const Vec& wi, Float pdf) {
  if (none(guided.at)) return pdf;
  return select(guided.at, guided_pdf(c.scene.lights.mirrored, guided.guide, load(v.p, i), wi, pdf), pdf);
}

/// A direction for each of the vertices i to i + width - 1; as `sample` of their BSDF where none is guided.
CASTRAY_INLINE BsdfSample sample_guided(const Context& c, const Vertices& v, int i, uint32_t vertex,
                                        const Shading& shading, Float lobe, Float u, Float w) {
  const Guided guided = guided_at(c, v, i, vertex);
  if (none(guided.at)) return sample(shading.bsdf, shading.wo, lobe, u, w);
  const Float share(guided_share);
  const Mask to_image = guided.at & (lobe < share);
  const Float rest = (lobe - share) * Float(1.f / (1 - guided_share));
  BsdfSample s = sample(shading.bsdf, shading.wo, select(guided.at & ~to_image, rest, lobe), u, w);
  const Vec wi = direction_to_image(c.scene.lights.mirrored, guided.guide, load(v.p, i),
                                    lobe * Float(1.f / guided_share), u, w);
  s.wi = select(to_image, to_local(shading.frame, wi), s.wi);
  const BsdfValue value = evaluate(shading.bsdf, shading.wo, s.wi);
  const Float pdf = pdf_with_guide(c, v, i, guided, to_world(shading.frame, s.wi), value.pdf);
  s.weight = select(guided.at, select(pdf > Float(0.f), value.f_cos * (Float(1.f) / pdf), black()), s.weight);
  s.pdf = select(guided.at, pdf, s.pdf);
  s.eta2 = select(guided.at & (value.pdf > Float(0.f)), pdf / value.pdf, s.eta2);
  return s;
}

}  // namespace castray::CASTRAY_ISA
