#pragma once

#include <vector>

#include "castray/scene.h"
#include "geometry/instance_records.h"
#include "geometry/wide_bvh.h"

namespace castray {

/// Trees of a scene's objects, and one over their instances, for the kernels.
class InstanceBvh {
 public:
  /// The scene has instances. The trees do not depend on `threads`. `quality`: of the objects' trees.
  static InstanceBvh build(const Scene& scene, int threads, BuildQuality quality);

  /// Valid as long as this lives.
  InstanceTree view() const;
  /// Triangles, nodes and bytes of all trees and instances together.
  const BvhStats& stats() const { return stats_; }

 private:
  void add_object(const MeshView& mesh, std::uint32_t first, int threads, BuildQuality quality);
  void build_top(int threads);

  std::vector<WideBvh> trees_;
  std::vector<KernelObject> objects_;
  std::vector<KernelInstance> instances_;
  BlockArray top_;
  WideBvhView top_view_{};
  std::uint32_t plain_ = 0;
  int depth_ = 0;
  float slack_ = 0;
  BvhStats stats_;
};

}  // namespace castray
