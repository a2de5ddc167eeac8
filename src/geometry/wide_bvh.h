#pragma once

#include "castray/render.h"
#include "geometry/block_array.h"
#include "geometry/bvh.h"
#include "geometry/wide_bvh_view.h"

namespace castray {

/// A bounding volume hierarchy with eight children a node and packets of eight triangles, for the
/// kernels. It holds the triangles' vertices itself and does not refer to the mesh. Its answers are those
/// of TriangleList, bit for bit.
class WideBvh {
 public:
  /// The hierarchy does not depend on `threads`. `best` cuts the boxes of wasteful triangles first, whatever
  /// it gains (see choose_build): three times the memory, five times the build. `automatic` is `fast`.
  static WideBvh build(const MeshView& mesh, int threads, BuildQuality quality = BuildQuality::fast);

  /// Valid as long as this lives.
  WideBvhView view() const { return view_; }
  const BvhStats& stats() const { return stats_; }

 private:
  BlockArray blocks_;
  WideBvhView view_{};
  BvhStats stats_;
};

}  // namespace castray
