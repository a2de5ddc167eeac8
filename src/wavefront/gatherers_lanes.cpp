#include "wavefront/gatherers_lanes.h"

namespace castray::CASTRAY_ISA {

/// Bounds of a range of vertices; entries without a hit do not count. A point at the origin if there is
/// none.
template <int vectors>
CASTRAY_INLINE Box bounds_of(const Vertices& x, int first) {
  const float* axes[3] = {x.p.x, x.p.y, x.p.z};
  Box box{};
  Mask valid[vectors];
  uint32_t found = 0;
  for (int i = 0; i < vectors; ++i) {
    valid[i] = length_squared(load(x.normal, first + i * width)) > Float(0.f);
    found |= bits(valid[i]);
  }
  if (!found) return box;
  for (int axis = 0; axis < 3; ++axis) {
    Float low(__builtin_inff()), high(-__builtin_inff());
    for (int i = 0; i < vectors; ++i) {
      const Float p = load(axes[axis] + first + i * width);
      low = select(valid[i], min(low, p), low);
      high = select(valid[i], max(high, p), high);
    }
    float l = lane(low, 0), h = lane(high, 0);
    for (int k = 1; k < width; ++k) {
      l = lane(low, k) < l ? lane(low, k) : l;
      h = lane(high, k) > h ? lane(high, k) : h;
    }
    box.center[axis] = 0.5f * (l + h);
    box.half[axis] = 0.5f * (h - l) * (1 + 0x1p-20f) + 0x1p-24f;
  }
  return box;
}

void bound_tile(const Vertices& x, int first, bool in_parts, TileBoxes& boxes) {
  boxes.all = bounds_of<tile_vectors>(x, first);
  if (!in_parts) return;
  for (int i = 0; i < tile_parts; ++i) boxes.part[i] = bounds_of<part_vectors>(x, first + i * part_pixels);
}

}  // namespace castray::CASTRAY_ISA
