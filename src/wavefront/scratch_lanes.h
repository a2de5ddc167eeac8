#pragma once

#include "wavefront/camera_connections_lanes.h"
#include "wavefront/chains_lanes.h"
#include "wavefront/gather_environment_lanes.h"
#include "wavefront/gather_suffixes_lanes.h"
#include "wavefront/light_lanes.h"

namespace castray::CASTRAY_ISA {

struct Scratch {
  FarEnds ends;
  Paths paths;
  PixelViews views;
  Hits hits;
  Vertices camera, vertices, glossy;
  Chains chains;
  alignas(64) uint32_t left_to_light_paths[Radiance::slots];  ///< see Context
  CameraConnections to_camera;
  Emissions light_paths, focused;
  ShadowRays shadow_rays;
  Radiance radiance;
  Suffixes suffixes;
  Gathered gathered;
  VisibilityScratch visibility;
  TileBoxes boxes[max_tiles];
  TileLights lights[max_tiles];
  VecArray<batch_size> direct;  ///< direct part of each pixel's sample
};

}  // namespace castray::CASTRAY_ISA
