#include "wavefront/origins_lanes.h"

namespace castray::CASTRAY_ISA {

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

void order_points(const Vertices& x, int first, bool by_normal, Origins& origins) {
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

/// Points of a tile by orientation.
struct Orientations {
  int count = 0;
  float normal[tile_pixels][3];                ///< of the first point of each
  int points[tile_pixels];                     ///< number
  float demand[tile_pixels];                   ///< for suffixes, for each point
  alignas(64) uint32_t of_pixel[tile_pixels];  ///< `none` where it sees no surface
  static constexpr uint32_t none = tile_pixels;
};

/// A bit for each point of the tile that lies nearly as a normal does.
CASTRAY_INLINE uint64_t points_along(const Vertices& x, int first, const float (&n)[3]) {
  constexpr float near_cosine = 0.9f;
  const Vec normal{Float(n[0]), Float(n[1]), Float(n[2])};
  uint64_t points = 0;
  for (int i = 0; i < tile_vectors; ++i) {
    const Float cosine = dot(normal, load(x.normal, first + i * width));
    points |= (uint64_t)bits(cosine > Float(near_cosine)) << (i * width);
  }
  return points;
}

void find_orientations(const Vertices& x, int first, Orientations& o) {
  uint64_t left = 0;
  for (int i = 0; i < tile_vectors; ++i) {
    store(o.of_pixel + i * width, Uint(Orientations::none));
    left |= (uint64_t)bits(length_squared(load(x.normal, first + i * width)) > Float(0.f)) << (i * width);
  }
  for (; left; ++o.count) {
    const int k = first + __builtin_ctzll(left);
    float(&normal)[3] = o.normal[o.count];
    normal[0] = x.normal.x[k], normal[1] = x.normal.y[k], normal[2] = x.normal.z[k];
    const uint64_t points = left & (points_along(x, first, normal) | 1ull << (k - first));
    o.points[o.count] = __builtin_popcountll(points);
    for (int i = 0; i < tile_vectors; ++i) {
      uint32_t* of_pixel = o.of_pixel + i * width;
      store(of_pixel, select(lanes_of(points, i), Uint((uint32_t)o.count), load(of_pixel)));
    }
    left &= ~points;
  }
}

/// 1 / sqrt(n) for points that lie as n do: one counts as the cosine between the normals, to the fourth
/// power.
void find_demand(Orientations& o) {
  for (int g = 0; g < o.count; ++g) {
    float alike = 0;
    for (int h = 0; h < o.count; ++h) {
      const float(&a)[3] = o.normal[g], (&b)[3] = o.normal[h];
      const float cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2], square = cosine * cosine;
      if (cosine > 0) alike += (float)o.points[h] * square * square;
    }
    o.demand[g] = 1 / __builtin_sqrtf(alike);
  }
}

/// Deals out the suffixes by demand. Those dealt to pixels that see no surface are not traced: where the
/// origins have such, they get so many that to a tile that sees surfaces in a share h of its pixels sqrt(h)
/// of all are left. So all tiles together have the least error for their suffixes.
void deal_out(const Orientations& o, int first, uint32_t suffixes, Origins& origins) {
  int seen = 0;
  float total = 0;
  for (int g = 0; g < o.count; ++g) seen += o.points[g], total += (float)o.points[g] * o.demand[g];
  const uint32_t all = suffixes << 16;
  const float to_seen = __builtin_sqrtf((float)seen / (float)origins.count);
  const float scale = 65535 * (float)suffixes / total * to_seen;  // rounding leaves some, for the last one
  const float over_mean = (float)origins.count / (float)all;
  uint32_t number[tile_pixels + 1];
  for (int g = 0; g < o.count; ++g) number[g] = (uint32_t)(scale * o.demand[g]);
  const int others = (int)origins.count - seen;
  number[o.none] = others > 0 ? (uint32_t)(65535 * (float)suffixes * (1 - to_seen) / (float)others) : 0;
  uint32_t begin = 0;
  for (uint32_t k = 0; k < origins.count; ++k) {
    const uint32_t pixel = origins.entry[k] - (uint32_t)first;
    origins.end[k] = k + 1 == origins.count ? all : begin + number[o.of_pixel[pixel]];
    origins.share[pixel] = (float)(origins.end[k] - begin) * over_mean;
    begin = origins.end[k];
  }
}

}  // namespace

void find_origins(const Vertices& x, int first, bool by_normal, uint32_t suffixes, Origins& origins) {
  order_points(x, first, by_normal, origins);
  Orientations orientations;
  find_orientations(x, first, orientations);
  origins.even = orientations.count == 0 || orientations.points[0] == (int)origins.count;
  if (origins.even) return;
  find_demand(orientations);
  deal_out(orientations, first, suffixes, origins);
}

}  // namespace castray::CASTRAY_ISA
