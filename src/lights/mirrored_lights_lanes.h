#pragma once

#include "lights/light_records.h"
#include "simd/vec_lanes.h"

// Directions to the images of lights in flat mirrors, mixed with those of BSDF sampling. Light sampling does
// not find what mirrors reflect, and BSDF sampling of a diffuse surface seldom.

namespace castray::CASTRAY_ISA {

/// How likely each image is chosen for surface points, up to the factor 1 / sum. sum 0: there is no image to
/// look for.
struct MirrorGuide {
  Float weight[most_mirrored_lights], sum;
};

/// Of directions at points that have images to look for.
inline constexpr float guided_share = 0.125f;

/// What an image might bring to point p with this normal, if it is behind its mirror as seen from there.
CASTRAY_INLINE Float weight_of(const MirroredLight& image, const Vec& p, const Vec& normal) {
  const Vec plane = broadcast(image.plane), center = broadcast(image.center), to = center - p;
  const Float height = dot(plane, p) - Float(image.offset), depth = Float(image.offset) - dot(plane, center);
  const Float along = height / (height + depth), radius(image.radius);
  const Vec beyond =
      magnitude(fma(to, along, p) - broadcast(image.mirror_center)) - broadcast(image.mirror_half);
  const Float facing = -dot(broadcast(image.normal), to), arriving = dot(normal, to);
  const Float distance2 = fma(radius, radius, length_squared(to));
  const Mask seen = (height > Float(0.f)) & (depth > Float(0.f)) & (max_component(beyond) < radius * along) &
                    (arriving > -radius);
  const Float emitting = image.two_sided ? abs(facing) : max(facing, Float(0.f));
  const Float cosine = max(arriving, Float(0.125f) * radius);
  return select(seen, Float(image.power) * emitting * cosine / (distance2 * distance2), Float(0.f));
}

CASTRAY_INLINE MirrorGuide guide_to_mirrors(const MirroredLightList& list, const Vec& p, const Vec& normal) {
  MirrorGuide guide;
  guide.sum = Float(0.f);
  for (int k = 0; k < list.count; ++k) {
    guide.weight[k] = weight_of(list.lights[k], p, normal);
    guide.sum += guide.weight[k];
  }
  return guide;
}

/// The pdf, per solid angle, with which a uniform point of the image is in direction w.
CASTRAY_INLINE Float pdf_of(const MirroredLight& image, const Vec& p, const Vec& w) {
  const Vec normal = broadcast(image.normal), from = broadcast(image.origin) - p;
  const Float cosine = dot(normal, w), distance = dot(normal, from) / cosine;
  const Vec q = w * distance - from;
  const Float a = dot(broadcast(image.across1), q), b = dot(broadcast(image.across2), q);
  const Float zero(0.f), one(1.f);
  const Mask there = (distance > zero) & (a >= zero) & (a <= one) & (b >= zero) & (b <= one);
  return select(there, distance * distance / (abs(cosine) * Float(image.area)), zero);
}

/// The pdf of direction w, where BSDF sampling alone would have `pdf`.
CASTRAY_INLINE Float guided_pdf(const MirroredLightList& list, const MirrorGuide& guide, const Vec& p,
                                const Vec& w, Float pdf) {
  Float to_images(0.f);
  for (int k = 0; k < list.count; ++k)
    to_images = fma(guide.weight[k], pdf_of(list.lights[k], p, w), to_images);
  const Float share(guided_share);
  return select(guide.sum > Float(0.f), fma(share, to_images / guide.sum, (Float(1.f) - share) * pdf), pdf);
}

/// A unit vector to a point of one of the images. `choice` chooses it; u and v the point.
CASTRAY_INLINE Vec direction_to_image(const MirroredLightList& list, const MirrorGuide& guide, const Vec& p,
                                      Float choice, Float u, Float v) {
  const Float target = choice * guide.sum;
  Float before(0.f);
  Vec to{Float(0.f), Float(0.f), Float(1.f)};
  for (int k = 0; k < list.count; ++k) {
    const MirroredLight& image = list.lights[k];
    const Mask chosen = (before <= target) & (guide.weight[k] > Float(0.f));
    const Vec point = fma(broadcast(image.edge2), v, fma(broadcast(image.edge1), u, broadcast(image.origin)));
    to = select(chosen, point - p, to);
    before += guide.weight[k];
  }
  return to * (Float(1.f) / sqrt(length_squared(to)));
}

}  // namespace castray::CASTRAY_ISA
