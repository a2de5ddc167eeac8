#include "wavefront/camera_rays_lanes.h"

#include "cameras/camera_lanes.h"
#include "wavefront/ragged_tiles_lanes.h"
#include "wavefront/sequence_keys_lanes.h"

namespace castray::CASTRAY_ISA {

/// The lowest bit of each of eight bytes, that of the first in bit 0.
CASTRAY_INLINE uint64_t low_bits_of_bytes(const uint8_t* bytes) {
  uint64_t all;
  __builtin_memcpy(&all, bytes, sizeof all);
  return ((all & 0x0101010101010101u) * 0x0102040810204080u) >> 56;  // byte i times 2^(56 - 7 i)
}

/// Looks up which pixels see an edge.
CASTRAY_INLINE void find_edges(const Context& c, bool ragged, TileResult& result) {
  const EdgeTable& table = c.scene.edges;
  const auto kinds_at = [&](int slot) {
    return table.kinds + ((int)result.y[slot] - table.y0) * table.width + ((int)result.x[slot] - table.x0);
  };
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    uint64_t edges = 0;
    for (int i = 0; i < tile_pixels; i += ragged ? 1 : tile_size) {
      const uint8_t* kinds = kinds_at(tile * tile_pixels + i);
      edges |= (ragged ? kinds[0] & uint64_t{1} : low_bits_of_bytes(kinds)) << i;
    }
    result.edges[tile] = edges;
  }
}

void place_pixels(const Context& c, TileResult& result) {
  const bool ragged = c.job.sample < c.options.ragged, in_strips = ragged && c.scene.edges.kinds;
  const uint32_t key = lane(hash_combine(Uint(c.options.seed ^ 0x3a99edu), Uint((uint32_t)c.job.sample)), 0);
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width) {
    const TilePlace tile = place_of(c.job, i / tile_pixels);
    const Uint left((uint32_t)(tile.grid_x * tile_size)), top((uint32_t)(tile.grid_y * tile_size));
    const Uint entry = Uint((uint32_t)i) + lane_index();
    Uint x = left + (entry & 7u), y = top + ((entry >> 3) & 7u);
    if (ragged && !in_strips) {
      x = swap_across_edge(key, x, y);
      y = swap_across_edge(key + 1, y, x);
    }
    store(result.x + i, x - left + Uint((uint32_t)tile.x));
    store(result.y + i, y - top + Uint((uint32_t)tile.y));
  }
  for (int tile = 0; in_strips && tile < c.job.tiles; ++tile) place_in_strips(c, key, tile, result);
  if (c.scene.edges.kinds) find_edges(c, ragged, result);
}

CASTRAY_INLINE Uint key_of_pixel(uint32_t seed, Uint x, Uint y) {
  return hash_combine(hash_combine(Uint(seed), x), y);
}

CASTRAY_INLINE uint32_t index_of(uint64_t sample) { return (uint32_t)sample & ((1u << index_bits) - 1); }

/// Draws the place in the pixel anew for pixels from number i on that see an edge. Their tile is repeated
/// alike in all samples, so that they take each number of the sequence once.
CASTRAY_INLINE void move_at_edges(const Context& c, const TileResult& pixels, int i, Uint x, Uint y,
                                  Float (&place)[4]) {
  const uint32_t edges = (uint32_t)(pixels.edges[i / tile_pixels] >> (i % tile_pixels)) & ((1u << width) - 1);
  if (edges == 0) return;
  const uint64_t sample = c.job.edge_sample + place_of(c.job, i / tile_pixels).repeat;
  const Uint key = with_epoch(key_of_pixel(c.job.edge_seed, x, y), sample);
  const Numbers<4> n = draw<4>(c.options.sobol, {key, Uint(index_of(sample))}, PathBlocks::camera);
  for (int d = 0; d < 2; ++d) place[d] = select(mask_of_bits(edges), n.u[d], place[d]);
}

/// Of the pixels (x,y) through one point of the lens; the samples are at (px,py).
CASTRAY_INLINE PixelView view_of(const KernelCamera& camera, Float x, Float y, Float px, Float py,
                                 const Numbers<2>& lens) {
  const auto ray = [&](float right, float down) {
    return camera_ray(camera, x + Float(right), y + Float(down), lens.u[0], lens.u[1]);
  };
  const CameraRay middle = ray(0.5f, 0.5f), right = ray(1.5f, 0.5f), down = ray(0.5f, 1.5f);
  return {middle.o, middle.d, right.o - middle.o, right.d - middle.d, down.o - middle.o, down.d - middle.d,
          px - x,   py - y};
}

void camera_rays(const Context& c, const TileResult& pixels, Paths& paths, PixelViews* views) {
  const KernelCamera& camera = c.scene.camera;
  paths.count = c.job.tiles * tile_pixels;
  for (int i = 0; i < paths.count; i += width) {
    const Uint entry = Uint((uint32_t)i) + lane_index();
    const Uint x = load(pixels.x + i), y = load(pixels.y + i);
    const TilePlace tile = place_of(c.job, i / tile_pixels);
    const Uint key = key_in(c, tile, key_of_pixel(c.options.seed, x, y));
    const uint32_t index = index_of(sample_of(c, tile));
    Numbers<4> n = draw<4>(c.options.sobol, {key, Uint(index)}, PathBlocks::camera);
    if (c.scene.edges.kinds) move_at_edges(c, pixels, i, x, y, n.u);
    const Float px = to_float(x) + (c.options.jitter ? n.u[0] : Float(0.5f));
    const Float py = to_float(y) + (c.options.jitter ? n.u[1] : Float(0.5f));
    const Numbers<2> lens = camera.has_lens ? draw<2>(c.options.sobol, {key, Uint(index)}, PathBlocks::lens)
                                            : Numbers<2>{Float(0.f), Float(0.f)};
    const CameraRay ray = camera_ray(camera, px, py, lens.u[0], lens.u[1]);
    if (views) store(*views, i, view_of(camera, to_float(x), to_float(y), px, py, lens));
    store(paths.o, i, ray.o);
    store(paths.d, i, ray.d);
    store(paths.throughput, i, Vec{Float(1.f), Float(1.f), Float(1.f)});
    store(paths.arrival + i, Float(counts_all));
    store(paths.eta2 + i, Float(1.f));
    store(paths.media + i, Uint(0u));
    store(paths.names.light_u + i, n.u[2]);
    store(paths.names.light_v + i, n.u[3]);
    store(paths.names.slot + i, entry);
    store(paths.names.key + i, key);
    store(paths.names.index + i, Uint(index));
  }
}

void keep_first_hits(const FirstHits& table, const TileResult& pixels, int count, const Hits& hits) {
  for (int i = 0; i < count; ++i) {
    const int x = (int)pixels.x[i] - table.x0, y = (int)pixels.y[i] - table.y0;
    if (x < 0 || x >= table.width || y < 0 || y >= table.height) continue;
    const int at = y * table.width + x;
    table.t[at] = hits.t[i];
    table.b1[at] = hits.b1[i];
    table.b2[at] = hits.b2[i];
    table.primitive[at] = hits.primitive[i];
  }
}

void recall_first_hits(const FirstHits& table, const TileResult& pixels, int count, Hits& hits) {
  for (int i = 0; i < count; i += width) {
    const Uint x = load(pixels.x + i) - Uint((uint32_t)table.x0),
               y = load(pixels.y + i) - Uint((uint32_t)table.y0);
    const Uint at = y * Uint((uint32_t)table.width) + x;
    store(hits.t + i, gather(table.t, at));
    store(hits.b1 + i, gather(table.b1, at));
    store(hits.b2 + i, gather(table.b2, at));
    store(hits.primitive + i, gather(table.primitive, at));
  }
}

}  // namespace castray::CASTRAY_ISA
