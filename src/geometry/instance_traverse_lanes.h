#pragma once

#include "core/contract.h"
#include "geometry/bvh_traverse_lanes.h"
#include "geometry/instance_lanes.h"

namespace castray::CASTRAY_ISA {

/// Every object lies in the box of these bounds.
inline constexpr WideBvhView unit_box{nullptr, 0, 0, 0, {-1, -1, -1}, {1, 1, 1}};

/// What of an object's triangles, numbered from `first` on in the scene, counts for a ray.
template <class Counts>
struct CountsInObject {
  Counts counts;
  uint32_t ray, first;
  CASTRAY_INLINE bool operator()(uint32_t /*entry*/, uint32_t triangle, float b1, float b2) const {
    return counts(ray, first + triangle, b1, b2);
  }
};

CASTRAY_INLINE void copy_ray(const RayGroup& from, uint32_t f, RayGroup& to, uint32_t t) {
  for (int i = 0; i < 3; ++i) {
    to.inverse[i][t] = from.inverse[i][f];
    to.near_offset[i][t] = from.near_offset[i][f];
    to.far_offset[i][t] = from.far_offset[i][f];
    to.origin[i][t] = from.origin[i][f];
    to.near_plane[i][t] = from.near_plane[i][f];
    to.axis[i][t] = from.axis[i][f];
  }
  to.direction_z[t] = from.direction_z[f];
  to.shear_x[t] = from.shear_x[f];
  to.shear_y[t] = from.shear_y[f];
  to.nearest[t] = from.nearest[f];
  to.octant[t] = from.octant[f];
  to.traceable[t] = from.traceable[f];
}

/// Where the hits of a group's rays go.
struct InstanceHits {
  float* t;
  uint32_t *triangle, *instance;
  float *b1, *b2;
};

/// Traces the rays of a group, several at a time and each a node, a leaf or the way into an instance in turn,
/// as trace_group does.
template <bool any, class Counts, class Batch>
class InstanceTraversal {
 public:
  static constexpr uint32_t slots = 32;

  /// `stack_t` and `stack_child`: room for slots times room_of(tree).
  CASTRAY_INLINE InstanceTraversal(const InstanceTree& tree, const Counts& counts, const Batch& rays,
                                   float* stack_t, uint32_t* stack_child)
      : tree_(tree), counts_(counts), rays_(rays), stack_t_(stack_t), stack_child_(stack_child) {}

  static CASTRAY_INLINE uint32_t room_of(const InstanceTree& tree) { return 7u * (uint32_t)tree.depth + 17; }

  /// Rays first .. first + count - 1, which the group holds.
  CASTRAY_INLINE void run(RayGroup& group, uint32_t first, uint32_t count, const InstanceHits& out) {
    group_ = &group;
    first_ = first;
    count_ = count;
    out_ = out;
    next_ = 0;
    node_count_ = leaf_count_ = entry_count_ = 0;
    for (uint32_t s = 0; s < slots; ++s) start(s);
    while (node_count_ + leaf_count_ + entry_count_ > 0) {
      visit_nodes();
      visit_leaves();
      enter_instances();
    }
  }

 private:
  CASTRAY_INLINE Stack stack_of(uint32_t s, uint32_t from) const {
    const uint32_t room = room_of(tree_);
    return {stack_t_ + s * room + from, stack_child_ + s * room + from};
  }
  CASTRAY_INLINE const char* address(uint32_t s) const {
    return blocks_[s] + (uint64_t)(child_[s] / child_unit) * block_bytes;
  }
  CASTRAY_INLINE bool is_inside(uint32_t s) const { return instance_[s] != no_hit; }
  CASTRAY_INLINE RayGroup& ray_group(uint32_t s) { return is_inside(s) ? inside_ : *group_; }
  CASTRAY_INLINE uint32_t ray_entry(uint32_t s) const { return is_inside(s) ? s : ray_[s]; }

  CASTRAY_INLINE void queue(uint32_t s, uint32_t child) {
    child_[s] = child;
    const bool is_leaf = child & leaf_flag;
    if (is_leaf && !is_inside(s)) {
      __builtin_prefetch(tree_.instances + child / child_unit);
      entries_[entry_count_++] = (uint8_t)s;
      return;
    }
    for (uint32_t line = 0; line < 5; ++line) __builtin_prefetch(address(s) + line * block_bytes);
    if (is_leaf)
      leaves_[leaf_count_++] = (uint8_t)s;
    else
      nodes_[node_count_++] = (uint8_t)s;
  }

  CASTRAY_INLINE void start(uint32_t s) {
    while (next_ < count_ && !group_->traceable[next_]) ++next_;
    if (next_ == count_) return;
    ray_[s] = next_++;
    size_[s] = base_[s] = 0;
    instance_[s] = no_hit;
    blocks_[s] = tree_.top.blocks;
    queue(s, tree_.top.root);
  }

  /// Goes back to the tree over instances, of which what lies behind a hit is of no interest any more.
  CASTRAY_INLINE void leave(uint32_t s) {
    const float nearest = inside_.nearest[s];
    if (nearest < group_->nearest[ray_[s]]) {
      group_->nearest[ray_[s]] = nearest;
      size_[s] = drop_farther(stack_of(s, 0), size_[s], nearest);
    }
    base_[s] = 0;
    instance_[s] = no_hit;
    blocks_[s] = tree_.top.blocks;
  }

  CASTRAY_INLINE void advance(uint32_t s) {
    if (is_inside(s) && size_[s] == base_[s]) leave(s);
    if (size_[s] == 0) return start(s);
    queue(s, stack_of(s, --size_[s]).child[0]);
  }

  /// Empties a queue into `now`, as slots may be queued anew while those are visited; returns how many.
  static CASTRAY_INLINE uint32_t take(const uint8_t* queue, uint32_t& count, uint8_t* now) {
    const uint32_t n = count;
    __builtin_memcpy(now, queue, slots);
    count = 0;
    return n;
  }

  CASTRAY_INLINE void visit_nodes() {
    uint8_t now[slots];
    const uint32_t n = take(nodes_, node_count_, now);
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t s = now[i];
      size_[s] +=
          enter_node(*(const WideNode*)address(s), ray_group(s), ray_entry(s), stack_of(s, 0), size_[s]);
      advance(s);
    }
  }

  CASTRAY_INLINE void visit_leaves() {
    uint8_t now[slots];
    const uint32_t n = take(leaves_, leaf_count_, now);
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t s = now[i];
      if (intersect_leaf(s)) size_[s] = any ? base_[s] = 0 : base_[s] + drop_behind_hit(s);
      advance(s);
    }
  }

  CASTRAY_INLINE uint32_t drop_behind_hit(uint32_t s) const {
    return drop_farther(stack_of(s, base_[s]), size_[s] - base_[s], out_.t[ray_[s]]);
  }

  CASTRAY_INLINE bool intersect_leaf(uint32_t s) {
    const uint32_t r = ray_[s], instance = instance_[s], first = tree_.objects[object_[s]].first;
    // of equally near hits, one on a lower instance stays, and one on a higher is replaced
    uint32_t& on = out_.instance[r];
    uint32_t triangle = on == instance ? out_.triangle[r] - first : on < instance ? 0 : no_hit;
    const CountsInObject<Counts> counts{counts_.in(instance), first_ + r, first};
    const TrianglePacket* packet = (const TrianglePacket*)address(s);
    bool found = false;
    for (uint32_t left = child_[s] % max_leaf_packets + 1; left; --left)
      found |= intersect_packet(*packet++, counts, inside_, s, out_.t[r], triangle, out_.b1[r], out_.b2[r]);
    if (!found) return false;
    out_.triangle[r] = triangle + first;
    on = instance;
    return true;
  }

  CASTRAY_INLINE void enter_instances() {
    uint8_t now[slots];
    const uint32_t n = take(entries_, entry_count_, now);
    alignas(64) uint32_t ray[slots + width] = {}, instance[slots + width] = {};
    for (uint32_t i = 0; i < n; ++i) {
      ray[i] = first_ + ray_[now[i]];
      instance[i] = child_[now[i]] / child_unit;
    }
    for (uint32_t i = 0; i < n; i += width) move_rays(load(ray + i), load(instance + i), i);
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t s = now[i];
      if (moved_.traceable[i]) {
        copy_ray(moved_, i, inside_, s);
        inside_.nearest[s] = group_->nearest[ray_[s]];
        const KernelObject& object = tree_.objects[object_[s] = tree_.instances[instance[i]].object];
        base_[s] = size_[s];
        instance_[s] = instance[i];
        blocks_[s] = object.bvh.blocks;
        queue(s, object.bvh.root);
      } else {
        advance(s);
      }
    }
  }

  /// Rays to the spaces of their instances' objects.
  CASTRAY_INLINE void move_rays(Uint ray, Uint instance, uint32_t to) {
    const InstanceLanes at(tree_.instances, instance);
    const Vec o{gather(rays_.ox, ray), gather(rays_.oy, ray), gather(rays_.oz, ray)};
    const Vec d{gather(rays_.dx, ray), gather(rays_.dy, ray), gather(rays_.dz, ray)};
    const Vec origin = InstanceLanes::product(at.to_object, o - at.translation);
    const Vec direction = InstanceLanes::product(at.to_object, d);
    prepare(moved_, to, unit_box, {origin.x, origin.y, origin.z}, {direction.x, direction.y, direction.z},
            Float(1.f));
  }

  const InstanceTree& tree_;
  const Counts& counts_;
  const Batch& rays_;
  float* stack_t_;
  uint32_t* stack_child_;
  RayGroup* group_ = nullptr;
  uint32_t first_ = 0, count_ = 0, next_ = 0;
  InstanceHits out_{};
  RayGroup inside_, moved_;  ///< in objects' spaces, by slot and by entry
  // by slot:
  uint32_t ray_[slots], size_[slots], child_[slots];
  uint32_t base_[slots];      ///< where the stack of the instance that the ray is in begins
  uint32_t instance_[slots];  ///< no_hit: in the tree over instances
  uint32_t object_[slots];
  const char* blocks_[slots];
  uint8_t nodes_[slots + 1], leaves_[slots + 1], entries_[slots + 1];
  uint32_t node_count_ = 0, leaf_count_ = 0, entry_count_ = 0;
};

}  // namespace castray::CASTRAY_ISA
