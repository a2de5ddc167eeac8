#include "wavefront/repeated_tiles.h"

namespace castray {

namespace {

/// Calls `combine` with each of the numbers that the samples of a tile consist of, in both.
template <class Combine>
void for_samples(const TileResult& part, int from, TileResult& result, int to, Combine combine) {
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < tile_pixels; ++i) {
      combine(part.radiance[c][from * tile_pixels + i], result.radiance[c][to * tile_pixels + i]);
      combine(part.emitted[c][from * tile_pixels + i], result.emitted[c][to * tile_pixels + i]);
    }
}

void copy_pixels(const TileResult& part, int from, TileResult& result, int to) {
  for (int i = 0; i < tile_pixels; ++i) {
    result.x[to * tile_pixels + i] = part.x[from * tile_pixels + i];
    result.y[to * tile_pixels + i] = part.y[from * tile_pixels + i];
  }
  result.edges[to] = part.edges[from];
}

}  // namespace

RepeatedTiles::RepeatedTiles(const TileJob& job, const PixelEdges& edges, int repeats) : job_(job) {
  for (int tile = 0; tile < job.tiles; ++tile) {
    const int x = job.x + tile * tile_size, y = job.y;
    const bool sees_edge = edges.any(x, y, x + tile_size, y + tile_size);
    const std::uint32_t takes = sees_edge ? static_cast<std::uint32_t>(repeats) : 1;
    for (std::uint32_t repeat = 0; repeat < takes; ++repeat)
      places_[static_cast<std::size_t>(count_++)] = {x, y, job.grid_x + tile, job.grid_y, repeat, takes};
  }
}

void RepeatedTiles::render(const std::function<void(const TileJob&)>& render, const TileResult& part,
                           TileResult& result) const {
  const int parts = (count_ + max_tiles - 1) / max_tiles;
  int tile = 0;
  for (int p = 0; p < parts; ++p) {
    const int begin = count_ * p / parts, end = count_ * (p + 1) / parts;
    TileJob job = job_;
    job.tiles = end - begin;
    job.places = &place(begin);
    render(job);
    for (int i = begin; i < end; ++i) {
      const int from = i - begin;
      const std::uint32_t repeat = place(i).repeat;
      if (repeat == 0) {
        copy_pixels(part, from, result, tile);
        for_samples(part, from, result, tile, [](float value, float& mean) { mean = value; });
      } else {
        const float share = 1 / static_cast<float>(repeat + 1);
        for_samples(part, from, result, tile,
                    [share](float value, float& mean) { mean += (value - mean) * share; });
      }
      if (is_last(i)) ++tile;
    }
  }
}

}  // namespace castray
