#pragma once

#include "castray/render.h"
#include "geometry/block_array.h"
#include "geometry/bvh.h"
#include "geometry/closed_surface.h"
#include "geometry/wide_bvh_view.h"

namespace castray {

/// A bounding volume hierarchy with eight children a node and packets of eight triangles, for the
/// kernels. It holds the triangles' vertices itself and does not refer to the mesh. Its answers are those
/// of TriangleList, bit for bit.
class WideBvh {
 public:
  /// The hierarchy does not depend on `threads`. `best` cuts the boxes of wasteful triangles first, whatever
  /// it gains (see choose_build): three times the memory, five times the build. `automatic` is `fast`.
  /// With a `surface` of the mesh, shafts may leave out its triangles that face what they are seen from.
  static WideBvh build(const MeshView& mesh, int threads, BuildQuality quality = BuildQuality::fast,
                       const ClosedSurface* surface = nullptr);

  /// Valid as long as this lives.
  WideBvhView view() const { return view_; }
  const BvhStats& stats() const { return stats_; }

 private:
  BlockArray blocks_;
  WideBvhView view_{};
  BvhStats stats_;
};

}  // namespace castray
