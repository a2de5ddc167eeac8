#include "wavefront/gatherers_lanes.h"

namespace castray::CASTRAY_ISA {

/// The box from `low` to `high`, somewhat larger.
CASTRAY_INLINE Box box_between(const float (&low)[3], const float (&high)[3]) {
  Box box;
  for (int a = 0; a < 3; ++a) {
    box.center[a] = 0.5f * (low[a] + high[a]);
    box.half[a] = 0.5f * (high[a] - low[a]) * (1 + 0x1p-20f) + 0x1p-24f;
  }
  return box;
}

/// Bounds of a range of vertices; entries without a hit do not count. A point at the origin if there is
/// none: `empty`.
template <int vectors>
CASTRAY_INLINE Box bounds_of(const Vertices& x, int first, bool& empty) {
  const float* axes[3] = {x.p.x, x.p.y, x.p.z};
  float lowest[3], highest[3];
  Mask valid[vectors];
  uint32_t found = 0;
  for (int i = 0; i < vectors; ++i) {
    valid[i] = length_squared(load(x.normal, first + i * width)) > Float(0.f);
    found |= bits(valid[i]);
  }
  empty = !found;
  if (empty) return {};
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
    lowest[axis] = l;
    highest[axis] = h;
  }
  return box_between(lowest, highest);
}

namespace {

/// A plane across an axis.
struct Cut {
  int axis;
  float at;
};

CASTRAY_INLINE bool is_on_surface(const Vertices& x, int i) {
  return x.normal.x[i] != 0 || x.normal.y[i] != 0 || x.normal.z[i] != 0;
}

/// Where the greatest gap along an axis is between a tile's points, as far as 16 bins tell; returns its
/// length.
float greatest_gap(const Vertices& x, const float* place, int first, float low, float high, float& at) {
  constexpr int bins = 16;
  const float scale = bins / (high - low), infinity = __builtin_inff();
  float lowest[bins], highest[bins];
  for (int b = 0; b < bins; ++b) lowest[b] = infinity, highest[b] = -infinity;
  for (int i = first; i < first + tile_pixels; ++i) {
    if (!is_on_surface(x, i)) continue;
    const float f = (place[i] - low) * scale;  // NaN where the box is flat
    const int b = f > 0 ? f < bins ? (int)f : bins - 1 : 0;
    lowest[b] = place[i] < lowest[b] ? place[i] : lowest[b];
    highest[b] = place[i] > highest[b] ? place[i] : highest[b];
  }
  float gap = 0, end = infinity;
  for (int b = 0; b < bins; ++b) {
    if (!(lowest[b] <= highest[b])) continue;
    if (lowest[b] - end > gap) gap = lowest[b] - end, at = 0.5f * (lowest[b] + end);
    end = highest[b];
  }
  return gap;
}

/// Makes the points on the two sides of a cut two groups.
void make_groups(const Vertices& x, int first, const Cut& cut, TileBoxes& boxes) {
  const float* axes[3] = {x.p.x + first, x.p.y + first, x.p.z + first};
  float low[2][3], high[2][3];
  for (int g = 0; g < 2; ++g) {
    boxes.pixels[g] = 0;
    for (int a = 0; a < 3; ++a) low[g][a] = __builtin_inff(), high[g][a] = -__builtin_inff();
  }
  for (int i = 0; i < tile_pixels; ++i) {
    if (!is_on_surface(x, first + i)) continue;
    const int g = axes[cut.axis][i] > cut.at;
    boxes.pixels[g] |= 1ull << i;
    for (int a = 0; a < 3; ++a) {
      const float p = axes[a][i];
      low[g][a] = p < low[g][a] ? p : low[g][a];
      high[g][a] = p > high[g][a] ? p : high[g][a];
    }
  }
  for (int g = 0; g < 2; ++g) boxes.group[g] = box_between(low[g], high[g]);
  boxes.groups = 2;
}

/// Makes two groups of a tile's points if a gap parts them that is wide beside their box.
void split_tile(const Vertices& x, int first, TileBoxes& boxes) {
  if (boxes.empty) return;
  constexpr float wide = 0.3f;
  const float *axes[3] = {x.p.x, x.p.y, x.p.z}, *center = boxes.all.center, *half = boxes.all.half;
  float widest = wide * (half[0] + half[1] + half[2]);
  Cut cut{-1, 0};
  for (int a = 0; a < 3; ++a) {
    float at = 0;
    const float gap = greatest_gap(x, axes[a], first, center[a] - half[a], center[a] + half[a], at);
    if (gap > widest) widest = gap, cut = {a, at};
  }
  if (cut.axis >= 0) make_groups(x, first, cut, boxes);
}

}  // namespace

void bound_tile(const Vertices& x, int first, bool in_parts, TileBoxes& boxes) {
  boxes.all = bounds_of<tile_vectors>(x, first, boxes.empty);
  boxes.groups = 1;
  boxes.pixels[0] = ~0ull;
  boxes.group[0] = boxes.all;
  if (!in_parts) return;
  bool empty;
  for (int i = 0; i < tile_parts; ++i)
    boxes.part[i] = bounds_of<part_vectors>(x, first + i * part_pixels, empty);
  split_tile(x, first, boxes);
}

float side_seen(const Vertices& x, int first) {
  int fronts = 0, seen = 0;
  for (int i = first; i < first + tile_pixels; i += width) {
    const Mask valid = length_squared(load(x.normal, i)) > Float(0.f);
    const Mask front = (load(x.material + i) >> 31) == Uint(1u);
    seen += count(valid);
    fronts += count(valid & front);
  }
  return 2 * fronts < seen ? -1.f : 1.f;
}

}  // namespace castray::CASTRAY_ISA
