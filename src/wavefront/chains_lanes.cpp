#include "wavefront/chains_lanes.h"

namespace castray::CASTRAY_ISA {

void start_chains(const Vertices& camera, Chains& chains) {
  chains.ends = camera;
  chains.any = false;
  for (int i = 0; i < camera.count; i += width) {
    store(chains.specular + i, Uint(1u));
    store(chains.ends.normal, i, black());
    store_kd(chains.ends.parameters, i, black());
  }
}

void take_chain_ends(const KernelScene& scene, const Paths& paths, Vertices& vertices, Chains& chains) {
  for (int k = 0; k < paths.count; ++k)
    if (!(paths.arrival[k] >= counts_all)) chains.specular[paths.names.slot[k]] = 0;
  const int found = vertices.count;
  vertices.count = 0;
  for (int i = 0; i < found; i += width) {
    const Mask active = first_lanes(found - i);
    const Uint slot = select(active, load(vertices.names.slot + i), Uint(0u));
    const Uint record = select(active, record_of(load(vertices.material + i)), Uint(0u));
    const Mask ends =
        active & has_traits(scene, record, trait_shareable) & (gather(chains.specular, slot) == Uint(1u));
    for (uint32_t left = bits(ends); left; left &= left - 1) {
      const int k = i + __builtin_ctz(left);
      copy_entry<VertexArrays>(chains.ends, (int)vertices.names.slot[k], vertices, k);
      chains.any = true;
    }
    compress_entries<VertexArrays>(vertices, vertices.count, active & ~ends, vertices, i);
    vertices.count += count(active & ~ends);
  }
}

}  // namespace castray::CASTRAY_ISA
