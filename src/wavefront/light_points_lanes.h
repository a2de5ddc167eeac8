#pragma once

#include "lights/lights_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/gatherers_lanes.h"

namespace castray::CASTRAY_ISA {

/// A light point for each of the vertices i to i + width - 1, which are number `vertex` of their paths.
/// `opaque`: no material of the scene transmits.
LightPoint vertex_light_points(const Context& c, const Vertices& vertices, int i, uint32_t vertex,
                               bool opaque);

/// The points of a tile, whose materials are opaque, as one receiver.
Receiver receiver_of(const Gatherers& tile);

/// The light points from number `first` on that a tile shares, in as many lanes as there are; with their side
/// chosen, and offset by their error.
LightPoint tile_light_points(const Context& c, const Receiver& tile, uint32_t tile_key, int first);

}  // namespace castray::CASTRAY_ISA
