#pragma once

#include "simd/isa_lanes.h"
#include "wavefront/kernel_api.h"

namespace castray::CASTRAY_ISA {

// The kernels: one for each combination of geometry and features that is compiled.
void render_tiles_list_diffuse(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch,
                               TileResult&);
void render_tiles_list(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch, TileResult&);
void render_tiles_bvh_diffuse(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch,
                              TileResult&);
void render_tiles_bvh(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch, TileResult&);
void render_tiles_bvh_detail(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch,
                             TileResult&);

void render_tiles_instances(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch,
                            TileResult&);

uint64_t trace_light_paths_list(const KernelScene&, const KernelOptions&, const LightPathJob&, void* scratch,
                                const SplatSink&);
uint64_t trace_light_paths_bvh(const KernelScene&, const KernelOptions&, const LightPathJob&, void* scratch,
                               const SplatSink&);
uint64_t trace_light_paths_bvh_detail(const KernelScene&, const KernelOptions&, const LightPathJob&,
                                      void* scratch, const SplatSink&);

}  // namespace castray::CASTRAY_ISA
