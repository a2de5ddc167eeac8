#include "accel/collapse.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace castray {
namespace {

float half_area(const BvhNode& node) {
  const float x = node.upper[0] - node.lower[0], y = node.upper[1] - node.lower[1],
              z = node.upper[2] - node.lower[2];
  return x * y + y * z + z * x;
}

/// The part of a binary tree that becomes one wide node.
class Treelet {
 public:
  Treelet(const BvhNode& root, const BinaryTree& tree) {
    items_[0] = {&root, 0};
    open(0, tree);
    while (children() < bvh_width) {
      int largest = -1;
      float area = -1;
      for (int i = 1; i < size_; ++i) {
        if (items_[i].node->is_leaf() || items_[i].first > 0) continue;
        if (const float a = half_area(*items_[i].node); a > area) largest = i, area = a;
      }
      if (largest < 0) break;
      open(largest, tree);
    }
    int slot = 0;
    for (int i = 1; i < size_; ++i) {
      if (items_[i].first == 0) items_[i].slot = slot, child_[slot++] = items_[i].node;
    }
  }

  int children() const { return (size_ + 1) / 2; }
  const BvhNode& child(int slot) const { return *child_[slot]; }

  /// Four bits a slot, the slot of the farthest child lowest, for a direction of this octant.
  std::uint32_t order(std::uint32_t octant) const {
    std::uint32_t slots = 0;
    int n = 0;
    append(0, octant, slots, n);
    for (; n < bvh_width; ++n) slots |= static_cast<std::uint32_t>(n) << (4 * n);  // unused: any
    return slots;
  }

 private:
  struct Item {
    const BvhNode* node;
    int first;  ///< of its two items here; 0: not opened
    int slot = 0;
    std::uint32_t axis = 0;  ///< along which they lie apart
    bool first_is_lower = true;
  };

  void open(int i, const BinaryTree& tree) {
    Item& item = items_[i];
    const BvhPair& pair = tree.pairs[item.node->first];
    item.first = size_;
    float widest = -std::numeric_limits<float>::infinity();
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const auto& [a, b] = pair.child;
      const float apart = std::abs((b.lower[axis] - a.lower[axis]) + (b.upper[axis] - a.upper[axis]));
      const float gap = apart - ((a.upper[axis] - a.lower[axis]) + (b.upper[axis] - b.lower[axis]));
      if (gap > widest) {
        widest = gap;
        item.axis = axis;
        item.first_is_lower = a.lower[axis] + a.upper[axis] <= b.lower[axis] + b.upper[axis];
      }
    }
    for (const BvhNode& child : pair.child) items_[size_++] = {&child, 0};
  }

  void append(int i, std::uint32_t octant, std::uint32_t& slots, int& n) const {
    const Item& item = items_[i];
    if (item.first == 0) {
      slots |= static_cast<std::uint32_t>(item.slot) << (4 * n++);
      return;
    }
    const bool negative = octant >> item.axis & 1;
    const int nearer = item.first_is_lower != negative ? 0 : 1;
    append(item.first + 1 - nearer, octant, slots, n);
    append(item.first + nearer, octant, slots, n);
  }

  Item items_[2 * bvh_width - 1];
  int size_ = 1;
  const BvhNode* child_[bvh_width];
};

std::uint32_t packets_of(const BvhNode& leaf) { return (leaf.count + packet_size - 1) / packet_size; }

/// How much a subtree fills.
struct Extent {
  std::uint32_t nodes = 0, packets = 0;
  int depth = 0;

  void add(const Extent& child) {
    nodes += child.nodes;
    packets += child.packets;
    depth = std::max(depth, child.depth + 1);
  }
};

/// A subtree that one task makes: where its root goes, and where its nodes and packets begin.
struct Job {
  const BvhNode* root;
  std::uint32_t* child;
  std::uint32_t node = 0, packet = 0;
  Extent extent;
};

class Collapser {
 public:
  Collapser(const BinaryTree& tree, const MeshView& mesh) : tree_(tree), mesh_(mesh) {}

  WideTree run(int threads) {
    const Extent all = plan(tree_.root, 0);
    const auto count = static_cast<std::int64_t>(jobs_.size());
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (count > 1)
    for (std::int64_t i = 0; i < count; ++i)
      jobs_[static_cast<std::size_t>(i)].extent = measure(*jobs_[static_cast<std::size_t>(i)].root);
    Extent total = all;
    for (Job& job : jobs_) {
      job.node = total.nodes;
      job.packet = total.packets;
      total.nodes += job.extent.nodes;
      total.packets += job.extent.packets;
      total.depth = std::max(total.depth, top_levels + job.extent.depth);
    }
    WideTree wide;
    wide.nodes = AlignedArray<WideNode>(total.nodes);
    wide.packets = AlignedArray<TrianglePacket>(total.packets);
    wide.depth = total.depth;
    wide_ = &wide;
    std::uint32_t node = 0, packet = 0;
    std::size_t job = 0;
    wide.root = make(tree_.root, node, packet, 0, &job);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (count > 1)
    for (std::int64_t i = 0; i < count; ++i) {
      Job& j = jobs_[static_cast<std::size_t>(i)];
      *j.child = make(*j.root, j.node, j.packet, 0, nullptr);
    }
    return wide;
  }

 private:
  static constexpr int top_levels = 3;

  /// Measures the levels above the jobs, and lists the jobs from left to right.
  Extent plan(const BvhNode& node, int level) {
    if (node.is_leaf()) return {0, packets_of(node), 0};
    if (level == top_levels) {
      jobs_.push_back({&node, nullptr, 0, 0, {}});
      return {};
    }
    const Treelet treelet(node, tree_);
    Extent extent{1, 0, 0};
    for (int slot = 0; slot < treelet.children(); ++slot) extent.add(plan(treelet.child(slot), level + 1));
    return extent;
  }

  Extent measure(const BvhNode& node) const {
    if (node.is_leaf()) return {0, packets_of(node), 0};
    const Treelet treelet(node, tree_);
    Extent extent{1, 0, 0};
    for (int slot = 0; slot < treelet.children(); ++slot) extent.add(measure(treelet.child(slot)));
    return extent;
  }

  /// Writes the subtree from `node` and `packet` on, which it moves past what it wrote. With `job`, leaves
  /// the subtrees of jobs out.
  std::uint32_t make(const BvhNode& binary, std::uint32_t& node, std::uint32_t& packet, int level,
                     std::size_t* job) {
    if (binary.is_leaf()) return make_leaf(binary, packet);
    const Treelet treelet(binary, tree_);
    const std::uint32_t index = node++;
    WideNode& wide = wide_->nodes[index];
    for (int slot = 0; slot < bvh_width; ++slot) {
      const bool used = slot < treelet.children();
      for (int axis = 0; axis < 3; ++axis) {
        constexpr float infinity = std::numeric_limits<float>::infinity();
        wide.lower[axis][slot] = used ? treelet.child(slot).lower[axis] : infinity;
        wide.upper[axis][slot] = used ? treelet.child(slot).upper[axis] : -infinity;
      }
      wide.child[slot] = 0;
    }
    for (std::uint32_t octant = 0; octant < 8; ++octant) wide.order[octant] = treelet.order(octant);
    for (int slot = 0; slot < treelet.children(); ++slot) {
      const BvhNode& child = treelet.child(slot);
      if (job && level + 1 == top_levels && !child.is_leaf()) {
        jobs_[(*job)++].child = &wide.child[slot];
      } else {
        wide.child[slot] = make(child, node, packet, level + 1, job);
      }
    }
    return index;
  }

  std::uint32_t make_leaf(const BvhNode& leaf, std::uint32_t& packet) {
    const std::uint32_t first = packet;
    packet += packets_of(leaf);
    for (std::uint32_t i = 0; i < packets_of(leaf) * packet_size; ++i) {
      TrianglePacket& out = wide_->packets[first + i / packet_size];
      const std::uint32_t lane = i % packet_size;
      const bool used = i < leaf.count;
      const std::uint32_t triangle = used ? tree_.primitives[leaf.first + i] : no_triangle;
      out.triangle[lane] = triangle;
      for (std::uint32_t v = 0; v < 3; ++v) {
        const Vec3f p = used ? mesh_.positions[mesh_.triangles[triangle][v]] : Vec3f();
        for (int axis = 0; axis < 3; ++axis) out.vertex[v][axis][lane] = p[axis];
      }
    }
    return leaf_flag | (first * max_leaf_packets) | (packets_of(leaf) - 1);
  }

  const BinaryTree& tree_;
  const MeshView& mesh_;
  WideTree* wide_ = nullptr;
  std::vector<Job> jobs_;
};

}  // namespace

WideTree collapse(const BinaryTree& tree, const MeshView& mesh, int threads) {
  return Collapser(tree, mesh).run(threads);
}

}  // namespace castray
