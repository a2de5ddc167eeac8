#pragma once

#include "wavefront/context_lanes.h"

namespace castray::CASTRAY_ISA {

/// Specular chains: paths from the camera that only mirrors and glass have scattered.
struct Chains {
  alignas(64) uint32_t specular[batch_size];  ///< by slot: 1 while the path is one
  /// Where chains end, at the first vertex through which many points may gather, in the entry of the pixel;
  /// elsewhere `normal` is (0,0,0). The throughput is the chain's.
  Vertices ends;
  bool any;  ///< ends
};

/// Starts the chains of the camera's vertices `camera`: none has an end yet.
void start_chains(const Vertices& camera, Chains& chains);

/// Moves ends of chains from `vertices`, which `paths` have found, to `chains`.
void take_chain_ends(const KernelScene& scene, const Paths& paths, Vertices& vertices, Chains& chains);

}  // namespace castray::CASTRAY_ISA
