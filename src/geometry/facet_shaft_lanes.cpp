#include "geometry/facet_shaft_lanes.h"

#include "geometry/pyramids_lanes.h"

namespace castray::CASTRAY_ISA {

/// Which of the balls around blockers i to i + width - 1 reach the box's, swept to the apex. Most facets are
/// far from light that arrives from one direction.
CASTRAY_INLINE Mask may_block(const BlockerList& /*blockers*/, uint32_t /*i*/, const NearApex&, const Vec&,
                              Float /*reach*/) {
  return Mask(true);
}
CASTRAY_INLINE Mask may_block(const BlockerList& blockers, uint32_t i, const FarApex& apex, const Vec& center,
                              Float reach) {
  const Vec to =
      Vec{load(blockers.center[0] + i), load(blockers.center[1] + i), load(blockers.center[2] + i)} - center;
  const Float along = dot(to, apex.w);
  const Vec aside = fma(apex.w, -along, to);
  constexpr float rounding = 0x1p-18f;
  const Float near = fma(sum_abs(to), Float(rounding), load(blockers.radius + i) + reach);
  return (along >= -near) & (length_squared(aside) <= near * near);
}

template <class Apex>
bool facet_shaft(const BlockerList& blockers, const Apex& apex, const Box& box, Shaft& out) {
  out.count = 0;
  const Vec center = broadcast(box.center), half = broadcast(box.half);
  const Float reach = sqrt(length_squared(half)) * Float(1 + 0x1p-18f);
  for (uint32_t i = 0; i < blockers.count; i += width) {
    const Mask lanes = first_lanes((int)(blockers.count - i)) & may_block(blockers, i, apex, center, reach);
    if (none(lanes)) continue;
    if (out.count > max_blockers) return false;
    Vec corner[4];
    for (int k = 0; k < 4; ++k)
      corner[k] = Vec{load(blockers.corner[k][0] + i), load(blockers.corner[k][1] + i),
                      load(blockers.corner[k][2] + i)};
    add_pyramids(apex, corner, center, half, lanes, out);
  }
  return true;
}

template bool facet_shaft(const BlockerList&, const NearApex&, const Box&, Shaft&);
template bool facet_shaft(const BlockerList&, const FarApex&, const Box&, Shaft&);

}  // namespace castray::CASTRAY_ISA
