#include "geometry/collapse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

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

constexpr std::uint32_t node_blocks = sizeof(WideNode) / block_bytes;
constexpr std::uint32_t packet_blocks = sizeof(TrianglePacket) / block_bytes;

/// Leaves as packets of triangles, behind the nodes above them.
class PacketLeaves {
 public:
  PacketLeaves(const BinaryTree& tree, const MeshView& mesh) : tree_(tree), mesh_(mesh) {}

  /// How many blocks a leaf fills.
  static std::uint32_t blocks(const BvhNode& leaf) { return packets(leaf) * packet_blocks; }

  /// The leaf as a child, with its blocks number `block` and on, at `out`.
  std::uint32_t write(const BvhNode& leaf, std::uint32_t block, char* out) const {
    auto* const packet = reinterpret_cast<TrianglePacket*>(out);
    for (std::uint32_t i = 0; i < packets(leaf) * packet_size; ++i)
      write_lane(leaf, i, packet[i / packet_size], i % packet_size);
    return block * child_unit + leaf_flag + packets(leaf) - 1;
  }

 private:
  static std::uint32_t packets(const BvhNode& leaf) { return (leaf.count + packet_size - 1) / packet_size; }

  void write_lane(const BvhNode& leaf, std::uint32_t i, TrianglePacket& out, std::uint32_t lane) const {
    const bool used = i < leaf.count;
    const std::uint32_t triangle = tree_.primitives[leaf.first + (used ? i : 0)];
    out.triangle[lane] = triangle;
    for (std::uint32_t v = 0; v < 3; ++v) {
      const std::uint32_t corner = used ? v : v % 2;
      const Vec3f& p = mesh_.positions[mesh_.triangles[triangle][corner]];
      for (int axis = 0; axis < 3; ++axis) out.vertex[v][axis][lane] = p[axis];
    }
  }

  const BinaryTree& tree_;
  const MeshView& mesh_;
};

/// Leaves as the number of their only primitive.
class SingleLeaves {
 public:
  explicit SingleLeaves(const BinaryTree& tree) : tree_(tree) {}

  static std::uint32_t blocks(const BvhNode&) { return 0; }
  std::uint32_t write(const BvhNode& leaf, std::uint32_t, char*) const {
    return tree_.primitives[leaf.first] * child_unit + leaf_flag;
  }

 private:
  const BinaryTree& tree_;
};

/// How much a subtree fills.
struct Extent {
  std::uint64_t nodes = 0, leaf_blocks = 0;
  int depth = 0;

  std::uint64_t blocks() const { return nodes * node_blocks + leaf_blocks; }

  void add(const Extent& child, int levels) {
    nodes += child.nodes;
    leaf_blocks += child.leaf_blocks;
    depth = std::max(depth, child.depth + levels);
  }
};

/// A subtree that one task makes: where its root is told, and where its blocks begin.
struct Job {
  const BvhNode* root;
  std::uint32_t* child;
  std::uint32_t block;
  Extent extent;
};

template <class Leaves>
class Collapser {
 public:
  Collapser(const BinaryTree& tree, const Leaves& leaves) : tree_(tree), leaves_(leaves) {}

  WideTree run(int threads) {
    Extent total = measure(tree_.root, 0, &jobs_);
    const auto count = static_cast<std::int64_t>(jobs_.size());
    const auto job = [&](std::int64_t i) -> Job& { return jobs_[static_cast<std::size_t>(i)]; };
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (count > 1)
    for (std::int64_t i = 0; i < count; ++i) job(i).extent = measure(*job(i).root, 0, nullptr);
    for (Job& j : jobs_) {
      j.block = static_cast<std::uint32_t>(total.blocks());
      total.add(j.extent, top_levels);
    }
    if (total.blocks() > max_blocks)
      throw std::length_error("the scene has too many triangles for one hierarchy");

    WideTree wide{BlockArray(std::max<std::size_t>(total.blocks(), 1) * block_bytes),
                  static_cast<std::uint32_t>(total.nodes), 0, total.depth};
    blocks_ = wide.blocks.data();
    std::uint32_t block = 0;
    Job* next = jobs_.data();
    wide.root = make(tree_.root, block, 0, &next);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (count > 1)
    for (std::int64_t i = 0; i < count; ++i) {
      std::uint32_t first = job(i).block;
      *job(i).child = make(*job(i).root, first, 0, nullptr);
    }
    return wide;
  }

 private:
  static constexpr int top_levels = 3;
  static constexpr std::uint64_t max_blocks = (std::uint64_t{1} << 32) / child_unit;

  /// With `jobs`, leaves out the subtrees `top_levels` down, and lists them.
  Extent measure(const BvhNode& node, int level, std::vector<Job>* jobs) const {
    if (node.is_leaf()) return {0, Leaves::blocks(node), 0};
    if (jobs && level == top_levels) {
      jobs->push_back({&node, nullptr, 0, {}});
      return {};
    }
    const Treelet treelet(node, tree_);
    Extent extent{1, 0, 0};
    for (int slot = 0; slot < treelet.children(); ++slot)
      extent.add(measure(treelet.child(slot), level + 1, jobs), 1);
    return extent;
  }

  /// Writes the subtree from `block` on, which it moves past what it wrote. With `next`, leaves out the
  /// subtrees of jobs, from *next on.
  std::uint32_t make(const BvhNode& binary, std::uint32_t& block, int level, Job** next) {
    if (binary.is_leaf()) return make_leaf(binary, block);
    const Treelet treelet(binary, tree_);
    const std::uint32_t child = block * child_unit;
    WideNode& wide = *reinterpret_cast<WideNode*>(blocks_ + std::size_t{block} * block_bytes);
    block += node_blocks;
    for (int slot = 0; slot < bvh_width; ++slot) {
      const bool used = slot < treelet.children();
      for (int axis = 0; axis < 3; ++axis) {
        constexpr float infinity = std::numeric_limits<float>::infinity();
        wide.lower[axis][slot] = used ? treelet.child(slot).lower[axis] : infinity;
        wide.upper[axis][slot] = used ? treelet.child(slot).upper[axis] : -infinity;
      }
      wide.child[slot] = 0;
      for (std::int16_t(&normal)[bvh_width] : wide.normal) normal[slot] = 0;
      wide.spread[slot] = no_surface;
    }
    for (std::uint32_t octant = 0; octant < 8; ++octant) wide.order[octant] = treelet.order(octant);
    for (int slot = 0; slot < treelet.children(); ++slot) {
      const BvhNode& node = treelet.child(slot);
      if (next && level + 1 == top_levels && !node.is_leaf()) {
        (*next)++->child = &wide.child[slot];
      } else {
        wide.child[slot] = make(node, block, level + 1, next);
      }
    }
    return child;
  }

  std::uint32_t make_leaf(const BvhNode& leaf, std::uint32_t& block) {
    const std::uint32_t first = block;
    block += Leaves::blocks(leaf);
    return leaves_.write(leaf, first, blocks_ + std::size_t{first} * block_bytes);
  }

  const BinaryTree& tree_;
  const Leaves& leaves_;
  char* blocks_ = nullptr;
  std::vector<Job> jobs_;
};

}  // namespace

WideTree collapse(const BinaryTree& tree, const MeshView& mesh, int threads) {
  return Collapser(tree, PacketLeaves(tree, mesh)).run(threads);
}

WideTree collapse_singles(const BinaryTree& tree, int threads) {
  return Collapser(tree, SingleLeaves(tree)).run(threads);
}

}  // namespace castray
