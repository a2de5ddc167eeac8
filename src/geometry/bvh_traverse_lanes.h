#pragma once

#include "geometry/ray_group_lanes.h"
#include "simd/octet_lanes.h"

namespace castray::CASTRAY_ISA {

/// What a ray has yet to visit: entry distances and children, the nearest last. Seven siblings a level, and
/// room for eight that a push writes whole.
struct Stack {
  float* t;
  uint32_t* child;
};

CASTRAY_INLINE F8 plane8(const WideNode& node, uint32_t offset) {
  return *(const F8*)((const char*)&node + offset);
}
CASTRAY_INLINE F8 vertex8(const TrianglePacket& packet, uint32_t vertex, uint32_t axis) {
  return *(const F8*)((const char*)packet.vertex[vertex] + axis);
}

/// Puts the children that the ray enters on the stack, from `size` on; returns how many.
CASTRAY_INLINE uint32_t enter_node(const WideNode& node, const RayGroup& group, uint32_t r,
                                   const Stack& stack, uint32_t size) {
  const F8 zero{};
  F8 near = zero, far = splat8(group.nearest[r]);
  for (int i = 0; i < 3; ++i) {
    const uint32_t plane = group.near_plane[i][r];
    const F8 inverse = splat8(group.inverse[i][r]);
    near = max8(near, about_mul_sub8(plane8(node, plane), inverse, splat8(group.near_offset[i][r])));
    far = min8(far, about_mul_sub8(plane8(node, plane ^ far_plane_flip[i]), inverse,
                                   splat8(group.far_offset[i][r])));
  }
  return push_in_order(near, far, node.child, node.order[group.octant[r]], stack.t + size,
                       stack.child + size);
}

/// Where one of the three is negative and another positive.
CASTRAY_INLINE uint32_t mixed_signs8(F8 u, F8 v, F8 w) {
  const F8 zero{};
  return both_less8<false>(min8(u, min8(v, w)), zero, zero, max8(u, max8(v, w)));
}

/// Tests a packet of a leaf; keeps the nearest hit of the ray that counts. Returns whether there was any.
template <class Counts>
CASTRAY_INLINE bool intersect_packet(const TrianglePacket& packet, const Counts& counts, RayGroup& group,
                                     uint32_t r, float& hit_t, uint32_t& hit_triangle, float& b1, float& b2) {
  F8 x[3], y[3], z[3];
  for (uint32_t v = 0; v < 3; ++v) {
    z[v] = vertex8(packet, v, group.axis[2][r]) - splat8(group.origin[2][r]);
    x[v] =
        (vertex8(packet, v, group.axis[0][r]) - splat8(group.origin[0][r])) - splat8(group.shear_x[r]) * z[v];
    y[v] =
        (vertex8(packet, v, group.axis[1][r]) - splat8(group.origin[1][r])) - splat8(group.shear_y[r]) * z[v];
  }
  const F8 plain_u = x[2] * y[1] - y[2] * x[1], plain_v = x[0] * y[2] - y[0] * x[2],
           plain_w = x[1] * y[0] - y[1] * x[0];
  const uint32_t candidates = 0xff ^ mixed_signs8(plain_u, plain_v, plain_w);
  if (!candidates) return false;

  const F8 u = difference_of_products8(x[2], y[1], y[2], x[1], candidates);
  const F8 v = difference_of_products8(x[0], y[2], y[0], x[2], candidates);
  const F8 w = difference_of_products8(x[1], y[0], y[1], x[0], candidates);
  const F8 det = u + v + w;
  const F8 t = (u * z[0] + v * z[1] + w * z[2]) / (det * splat8(group.direction_z[r]));
  const uint32_t ahead =
      both_less8<true>(t, splat8(group.nearest[r]), splat8(__FLT_DENORM_MIN__), t);  // not if det is 0
  bool found = false;
  for (uint32_t hits = candidates & ahead & ~mixed_signs8(u, v, w); hits; hits &= hits - 1) {
    const int l = __builtin_ctz(hits);
    if (t[l] < hit_t || (t[l] == hit_t && packet.triangle[l] < hit_triangle)) {
      const float at1 = v[l] / det[l], at2 = w[l] / det[l];
      if (!counts(r, packet.triangle[l], at1, at2)) continue;
      group.nearest[r] = hit_t = t[l];
      hit_triangle = packet.triangle[l];
      b1 = at1;
      b2 = at2;
      found = true;
    }
  }
  return found;
}

/// Takes what begins behind `nearest` off the stack; returns its new size.
CASTRAY_INLINE uint32_t drop_farther(const Stack& stack, uint32_t size, float nearest) {
  uint32_t kept = 0;
  for (uint32_t i = 0; i < size; i += 8) kept += pack8(stack.t, stack.child, i, size - i, nearest, kept);
  return kept;
}

/// Traces the rays of a group, several at a time and each a node or a leaf in turn: while one waits for
/// memory the others work, and what is done next branches the same way for all.
template <bool any, class Counts, class Output>
CASTRAY_INLINE void trace_group(const WideBvhView& bvh, const Counts& counts, RayGroup& group, uint32_t count,
                                float* stack_t, uint32_t* stack_child, const Output& out) {
  constexpr uint32_t slots = 32;
  const uint32_t room = 7u * (uint32_t)bvh.depth + 9;
  uint32_t ray[slots], size[slots], child[slots];
  uint8_t nodes[slots + 1], leaves[slots + 1];
  uint32_t node_count = 0, leaf_count = 0, next = 0;

  const auto address = [&](uint32_t c) { return bvh.blocks + (uint64_t)(c / child_unit) * block_bytes; };
  const auto queue = [&](uint32_t s, uint32_t c) {
    child[s] = c;
    for (uint32_t line = 0; line < 5; ++line) __builtin_prefetch(address(c) + line * block_bytes);
    nodes[node_count] = (uint8_t)s;
    leaves[leaf_count] = (uint8_t)s;
    const uint32_t is_leaf = c / leaf_flag & 1;
    node_count += 1 - is_leaf;
    leaf_count += is_leaf;
  };
  const auto start = [&](uint32_t s) {
    while (next < count && !group.traceable[next]) ++next;
    if (next == count) return;
    ray[s] = next++;
    size[s] = 0;
    queue(s, bvh.root);
  };
  const auto advance = [&](uint32_t s) {
    if (size[s] == 0) return start(s);
    queue(s, stack_child[s * room + --size[s]]);
  };

  for (uint32_t s = 0; s < slots; ++s) start(s);
  while (node_count + leaf_count > 0) {
    uint8_t now[slots];
    uint32_t n = node_count;
    __builtin_memcpy(now, nodes, slots);
    node_count = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t s = now[i];
      const Stack stack{stack_t + s * room, stack_child + s * room};
      size[s] += enter_node(*(const WideNode*)address(child[s]), group, ray[s], stack, size[s]);
      advance(s);
    }
    n = leaf_count;
    __builtin_memcpy(now, leaves, slots);
    leaf_count = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t s = now[i], r = ray[s];
      const TrianglePacket* packet = (const TrianglePacket*)address(child[s]);
      bool found = false;
      for (uint32_t left = child[s] % max_leaf_packets + 1; left; --left) {
        found |=
            intersect_packet(*packet++, counts, group, r, out.t[r], out.triangle[r], out.b1[r], out.b2[r]);
      }
      if (found) {
        const Stack stack{stack_t + s * room, stack_child + s * room};
        size[s] = any ? 0 : drop_farther(stack, size[s], out.t[r]);
      }
      advance(s);
    }
  }
}

}  // namespace castray::CASTRAY_ISA
