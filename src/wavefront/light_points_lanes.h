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

/// Light points of a tile from number `first` on, as many as there are lanes or points left: emitting
/// side chosen, and offset to that side by their error.
LightPoint tile_light_points(const Context& c, const Receiver& tile, uint32_t tile_key, int first);

}  // namespace castray::CASTRAY_ISA
