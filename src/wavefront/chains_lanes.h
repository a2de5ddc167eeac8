#pragma once

#include "wavefront/context_lanes.h"

namespace castray::CASTRAY_ISA {

/// Where chains end, in the entry of the pixel; elsewhere `normal` is (0,0,0). The throughput is the chain's.
struct ChainEnds {
  Vertices vertices;
  bool any;
};

/// Chains: paths from the camera by way of surfaces that do not gather, up to the first vertex that does.
/// Those whose caustics are left to light paths, [1], gather apart from the others, [0].
struct Chains {
  ChainEnds ends[2];
};

/// Starts the chains of the camera's vertices `camera`: none has an end yet.
void start_chains(const Context& c, const Vertices& camera, Chains& chains);

/// Moves ends of chains from `vertices` to `chains`.
void take_chain_ends(const Context& c, Vertices& vertices, Chains& chains);

}  // namespace castray::CASTRAY_ISA
