#include "wavefront/chains_lanes.h"

namespace castray::CASTRAY_ISA {

void start_chains(const Context& c, const Vertices& camera, Chains& chains) {
  for (ChainEnds& ends : chains.ends) {
    ends.any = false;
    if (&ends != chains.ends && !c.left_to_light_paths) return;
    ends.vertices = camera;
    for (int i = 0; i < camera.count; i += width) {
      store(ends.vertices.normal, i, black());
      store_kd(ends.vertices.parameters, i, black());
    }
  }
}

void take_chain_ends(const Context& c, Vertices& vertices, Chains& chains) {
  const int found = vertices.count;
  vertices.count = 0;
  for (int i = 0; i < found; i += width) {
    const Mask active = first_lanes(found - i);
    const Uint record = select(active, record_of(load(vertices.material + i)), Uint(0u));
    const Mask at_end = active & gathers(c.scene, record);
    for (uint32_t left = bits(at_end); left; left &= left - 1) {
      const int k = i + __builtin_ctz(left);
      const uint32_t slot = vertices.names.slot[k];
      ChainEnds& ends = chains.ends[c.left_to_light_paths ? c.left_to_light_paths[slot] : 0];
      copy_entry<VertexArrays>(ends.vertices, (int)slot, vertices, k);
      ends.any = true;
    }
    compress_entries<VertexArrays>(vertices, vertices.count, active & ~at_end, vertices, i);
    vertices.count += count(active & ~at_end);
  }
}

}  // namespace castray::CASTRAY_ISA
