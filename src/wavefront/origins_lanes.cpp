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

CASTRAY_INLINE Vec normal_at(const Vertices& x, int i) {
  return {Float(x.normal.x[i]), Float(x.normal.y[i]), Float(x.normal.z[i])};
}

/// Whether all points of a tile are on surfaces that lie so nearly alike that all find the same paths.
CASTRAY_INLINE bool lie_alike(const Vertices& x, int first) {
  constexpr float near_cosine = 0.8f;
  const Vec normal = normal_at(x, first);
  Mask apart(false);
  for (int i = first; i < first + tile_pixels; i += width)
    apart = apart | (dot(normal, load(x.normal, i)) < Float(near_cosine));
  return none(apart);
}

/// By pixel, 1 / sqrt(n), with n the number of points that lie alike, itself among them: one counts as the
/// cosine between the normals, to the fourth power. 0 if the pixel sees no surface.
CASTRAY_INLINE void find_demand(const Vertices& x, int first, float* demand) {
  Float alike[tile_vectors];
  for (Float& n : alike) n = Float(0.f);
  for (int k = first; k < first + tile_pixels; ++k) {
    const Vec normal = normal_at(x, k);
    for (int i = 0; i < tile_vectors; ++i) {
      const Float cosine = max(dot(normal, load(x.normal, first + i * width)), Float(0.f));
      alike[i] += square(square(cosine));
    }
  }
  for (int i = 0; i < tile_vectors; ++i)
    store(demand + i * width,
          select(alike[i] > Float(0.f), Float(1.f) / sqrt(max(alike[i], Float(0.5f))), Float(0.f)));
}

/// Suffixes dealt to pixels that see no surface are not traced. Of a tile that sees surfaces in a share h of
/// its pixels they leave sqrt(h): in all tiles together these have the least error for their suffixes.
CASTRAY_INLINE void leave_out_others(float* demand) {
  int seen = 0;
  float total = 0;
  for (int i = 0; i < tile_pixels; ++i) seen += demand[i] > 0, total += demand[i];
  if (seen == 0 || seen == tile_pixels) return;
  const float all = total * __builtin_sqrtf((float)tile_pixels / (float)seen);
  for (int i = 0; i < tile_pixels; ++i)
    if (demand[i] == 0) demand[i] = (all - total) / (float)(tile_pixels - seen);
}

/// Deals out the suffixes by demand.
CASTRAY_INLINE void deal_out(int first, uint32_t suffixes, const float* demand, Origins& origins) {
  const uint32_t all = suffixes << 16;
  float total = 0;
  for (uint32_t k = 0; k < origins.count; ++k) total += demand[origins.entry[k] - (uint32_t)first];
  origins.even = total == 0;
  if (origins.even) return;
  const float scale = 65535 * (float)suffixes / total;  // rounding leaves some, for the last one
  const float over_mean = (float)origins.count / (float)all;
  uint32_t begin = 0;
  for (uint32_t k = 0; k < origins.count; ++k) {
    const uint32_t pixel = origins.entry[k] - (uint32_t)first;
    origins.end[k] = k + 1 == origins.count ? all : begin + (uint32_t)(scale * demand[pixel]);
    origins.share[pixel] = (float)(origins.end[k] - begin) * over_mean;
    begin = origins.end[k];
  }
}

}  // namespace

void find_origins(const Vertices& x, int first, bool by_normal, uint32_t suffixes, Origins& origins) {
  order_points(x, first, by_normal, origins);
  origins.even = lie_alike(x, first);
  if (origins.even) return;
  alignas(64) float demand[tile_pixels];
  find_demand(x, first, demand);
  if (!by_normal) leave_out_others(demand);
  deal_out(first, suffixes, demand, origins);
}

}  // namespace castray::CASTRAY_ISA
