#include "wavefront/gatherers_lanes.h"

namespace castray::CASTRAY_ISA {

/// Bounds of a range of vertices; entries without a hit do not count. A point at the origin if there is
/// none: `empty`.
template <int vectors>
CASTRAY_INLINE Box bounds_of(const Vertices& x, int first, bool& empty) {
  const float* axes[3] = {x.p.x, x.p.y, x.p.z};
  Box box{};
  Mask valid[vectors];
  uint32_t found = 0;
  for (int i = 0; i < vectors; ++i) {
    valid[i] = length_squared(load(x.normal, first + i * width)) > Float(0.f);
    found |= bits(valid[i]);
  }
  empty = !found;
  if (empty) return box;
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
  boxes.all = bounds_of<tile_vectors>(x, first, boxes.empty);
  if (!in_parts) return;
  bool empty;
  for (int i = 0; i < tile_parts; ++i)
    boxes.part[i] = bounds_of<part_vectors>(x, first + i * part_pixels, empty);
}

namespace {

constexpr uint32_t normal_cells = 6 * 25;

/// The cell of a normal: its largest axis and side, and a grid of 5x5 over the other two components, which
/// are within 0.71. Normals along the axes are in the middle of their cells.
CASTRAY_INLINE uint32_t cell_of(const float (&n)[3]) {
  const float x = __builtin_fabsf(n[0]), y = __builtin_fabsf(n[1]), z = __builtin_fabsf(n[2]);
  const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  const auto cell = [&](int other) { return (uint32_t)(3 * n[(axis + other) % 3] + 2.5f); };
  return (uint32_t)(2 * axis + (n[axis] < 0)) * 25 + cell(1) * 5 + cell(2);
}

}  // namespace

void find_origins(const Vertices& x, int first, bool by_normal, Origins& origins) {
  origins.count = tile_pixels;
  for (int i = 0; i < tile_pixels; ++i) origins.entry[i] = (uint32_t)(first + i);
  if (!by_normal) return;
  uint32_t cell[tile_pixels], begin[normal_cells + 2] = {};
  for (int i = 0; i < tile_pixels; ++i) {
    const float n[3] = {x.normal.x[first + i], x.normal.y[first + i], x.normal.z[first + i]};
    const bool on_surface = n[0] != 0 || n[1] != 0 || n[2] != 0;
    cell[i] = on_surface ? cell_of(n) : normal_cells;
    ++begin[cell[i] + 1];
  }
  for (uint32_t i = 0; i <= normal_cells; ++i) begin[i + 1] += begin[i];
  origins.count = begin[normal_cells] > 0 ? begin[normal_cells] : 1;
  for (int i = 0; i < tile_pixels; ++i) origins.entry[begin[cell[i]]++] = (uint32_t)(first + i);
}

}  // namespace castray::CASTRAY_ISA
