#pragma once

#include <array>
#include <functional>

#include "castray/render_options.h"
#include "wavefront/kernel_api.h"
#include "wavefront/pixel_edges.h"

namespace castray {

/// A job in which each tile that sees an edge is repeated: its sample is the mean of the repeats. In images
/// from differences most of the error is there, where pixels have noise of their own and surfaces are near
/// each other. What is repeated depends on the scene's shapes alone, never on what samples bring, so that
/// means stay unbiased. A pixel that sees an edge has as many repeats in every sample: also where edges of
/// tiles are ragged it stays in its tile's square (ragged_tiles_lanes.h), the only place looked at.
class RepeatedTiles {
 public:
  /// `repeats`: most_edge_samples at most.
  RepeatedTiles(const TileJob& job, const PixelEdges& edges, int repeats);

  bool any_repeated() const { return count_ > job_.tiles; }

  /// `render` renders a job into `part`. What the tiles have on average goes to `result`, but for its counts.
  void render(const std::function<void(const TileJob&)>& render, const TileResult& part,
              TileResult& result) const;

 private:
  bool is_last(int i) const { return i + 1 == count_ || place(i + 1).repeat == 0; }
  const TilePlace& place(int i) const { return places_[static_cast<std::size_t>(i)]; }

  TileJob job_;
  int count_ = 0;
  std::array<TilePlace, max_tiles * most_edge_samples> places_;  ///< a tile's repeats one after the other
};

}  // namespace castray
