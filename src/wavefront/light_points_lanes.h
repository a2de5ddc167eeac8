#pragma once

#include "lights/lights_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/gatherers_lanes.h"
#include "wavefront/sequence_keys_lanes.h"

namespace castray::CASTRAY_ISA {

/// A light point for each of the vertices i to i + width - 1, which are number `vertex` of their paths.
/// `opaque`: no material of the scene transmits.
LightPoint vertex_light_points(const Context& c, const Vertices& vertices, int i, uint32_t vertex,
                               bool opaque);

/// A direction to the environment, as a light point at infinity, for each of them.
LightPoint vertex_environment_points(const Context& c, const Vertices& vertices, int i, uint32_t vertex);

/// A light without size for each of them.
LightPoint vertex_delta_lights(const Context& c, const Vertices& vertices, int i, uint32_t vertex);

/// What a tile knows of the nodes of the light tree's cut.
struct TileLights {
  alignas(64) float seen[most_light_cut];     ///< as LightRegions::seen, summed over the tile's points
  alignas(64) float density[most_light_cut];  ///< as LightRegions::density, of the tile's light points
};

/// The points of a tile, whose materials are opaque, as one receiver, which refers to `lights`. Where
/// regions are known, fills in `lights`.
Receiver receiver_of(const Context& c, const Gatherers& tile, TileLights& lights);

/// Light points of a tile from number `first` on, as many as there are lanes or points left: emitting
/// side chosen, and offset to that side by their error. Their density is that of the tile's points.
LightPoint tile_light_points(const Context& c, const Receiver& tile, const TileLights& lights,
                             const TileSequence& sequence, int first);

}  // namespace castray::CASTRAY_ISA
