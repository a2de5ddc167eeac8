#include "geometry/bvh_build.h"

#include <bit>
#include <memory>
#include <utility>

#include "geometry/binning.h"
#include "geometry/presplit.h"

namespace castray {
namespace {

constexpr std::uint32_t chunk_size = 1 << 14;            ///< primitives of one parallel step
constexpr std::uint32_t parallel_size = 4 * chunk_size;  ///< ranges above are split by several threads
constexpr std::uint32_t subtree_size = 1 << 12;          ///< ranges up to this are one task

/// Primitives [begin, end) of the array `from`; the other array is free there.
struct Range {
  std::uint32_t begin, end;
  int from;
  int depth;
  Bounds box;

  std::uint32_t size() const { return end - begin; }
};

/// The upper part of the tree while it is built; its leaves own whole subtrees.
struct Subtree {
  BvhNode root;  ///< `first` of an inner root counts from this subtree's own first pair
  std::vector<BvhPair> pairs;
  std::unique_ptr<Subtree> child[2];
  Bounds box;
  int depth = 0;               ///< of its deepest leaf, from the whole tree's root
  double cost = 0;             ///< half areas times costs, summed
  std::size_t pair_count = 0;  ///< in all
};

BvhNode make_node(const Bounds& box, std::uint32_t first, std::uint32_t count) {
  const Vec3f lower = to_vec3(box.lower), upper = to_vec3(box.upper);
  return {{lower.x, lower.y, lower.z}, first, {upper.x, upper.y, upper.z}, count};
}

template <class Body>
void for_chunks(std::uint32_t begin, std::uint32_t end, const Body& body) {
  const std::uint32_t chunks = (end - begin + chunk_size - 1) / chunk_size;
#pragma omp taskloop grainsize(1) default(shared)
  for (std::uint32_t c = 0; c < chunks; ++c) {
    const std::uint32_t first = begin + c * chunk_size;
    body(c, first, std::min(end, first + chunk_size));
  }
}

class Builder {
 public:
  Builder(const MeshView& mesh, const BuildParameters& parameters) : mesh_(mesh), parameters_(parameters) {
    if (parameters.split_share > 0) given_refs_ = presplit(mesh, parameters.split_share, parameters.threads);
    count_ = given_refs_.empty() ? mesh.count : static_cast<std::uint32_t>(given_refs_.size());
    make_room();
  }
  Builder(std::vector<PrimRef>&& refs, const BuildParameters& parameters)
      : parameters_(parameters),
        given_refs_(std::move(refs)),
        count_(static_cast<std::uint32_t>(given_refs_.size())) {
    make_room();
  }

  BinaryTree build() {
    BinaryTree tree;
    tree.primitives.resize(count_);
    primitives_ = tree.primitives.data();
#pragma omp parallel num_threads(parameters_.threads) if (count_ > subtree_size)
#pragma omp single
    {
      Subtree top;
      build_top(make_refs(), top);
      refs_[0].reset();
      refs_[1].reset();
      tree.pairs.resize(top.pair_count);
      tree.root = top.root;
      tree.depth = top.depth;
      const float area = half_area(top.box);
      tree.sah_cost = area > 0 ? top.cost / area : 0;
      place(top, tree.root, tree.pairs.data(), 0);
    }
    return tree;
  }

 private:
  void make_room() {
    for (auto& refs : refs_) refs = std::make_unique_for_overwrite<PrimRef[]>(count_);
  }

  Range make_refs() {
    const std::uint32_t n = count_;
    std::vector<Bounds> chunk_box((n + chunk_size - 1) / chunk_size);
    for_chunks(0, n, [&](std::uint32_t c, std::uint32_t first, std::uint32_t last) {
      Bounds all;
      for (std::uint32_t i = first; i < last; ++i) {
        refs_[0][i] = given_refs_.empty() ? PrimRef(triangle_bounds(mesh_, i), i) : given_refs_[i];
        all.add(refs_[0][i].lower, refs_[0][i].upper);
      }
      chunk_box[c] = all;
    });
    given_refs_ = {};
    Range range{0, n, 0, 0, {}};
    for (const Bounds& box : chunk_box) range.box.add(box);
    return range;
  }

  void build_top(const Range& range, Subtree& out) {
    out.box = range.box;
    if (range.size() <= subtree_size) {
      out.pairs.reserve(range.size() / 4);
      out.root = build_serial(range, out);
      out.pair_count = out.pairs.size();
      return;
    }
    Range side[2];
    split(range, side[0], side[1]);
    for (auto& child : out.child) child = std::make_unique<Subtree>();
#pragma omp task default(shared)
    build_top(side[0], *out.child[0]);
    build_top(side[1], *out.child[1]);
#pragma omp taskwait
    out.root = make_node(range.box, 0, 0);
    out.depth = std::max(out.child[0]->depth, out.child[1]->depth);
    out.pair_count = 1 + out.child[0]->pair_count + out.child[1]->pair_count;
    out.cost = node_cost(range.box) + out.child[0]->cost + out.child[1]->cost;
  }

  BvhNode build_serial(const Range& range, Subtree& out) {
    Range side[2];
    if (!split(range, side[0], side[1])) return make_leaf(range, out);
    const auto pair = static_cast<std::uint32_t>(out.pairs.size());
    out.pairs.emplace_back();
    out.cost += node_cost(range.box);
    for (int i = 0; i < 2; ++i) {
      const BvhNode child = build_serial(side[i], out);
      out.pairs[pair].child[i] = child;
    }
    return make_node(range.box, pair, 0);
  }

  BvhNode make_leaf(const Range& range, Subtree& out) {
    for (std::uint32_t i = range.begin; i < range.end; ++i) primitives_[i] = refs_[range.from][i].id();
    out.depth = std::max(out.depth, range.depth);
    out.cost += static_cast<double>(leaf_cost(range));
    return make_node(range.box, range.begin, range.size());
  }

  double node_cost(const Bounds& box) const {
    return static_cast<double>(parameters_.traversal_cost * half_area(box));
  }
  float leaf_cost(const Range& range) const {
    const std::uint32_t block = 1u << parameters_.leaf_block_log2;
    return half_area(range.box) * static_cast<float>((range.size() + block - 1) / block);
  }

  /// Cuts the range in two, or says that it is best a leaf.
  bool split(const Range& range, Range& left, Range& right) {
    const std::uint32_t n = range.size();
    if (n == 1) return false;
    const int halvings = std::bit_width(n - 1);  // to single primitives
    const bool hurry = range.depth + halvings >= max_bvh_depth;
    const BinMap map(centroid_bounds(range), n);
    if (!hurry && !map.is_degenerate()) {
      const Bins bins = fill_bins(range, map);
      const Split best = bins.best_split(parameters_.leaf_block_log2);
      if (n <= parameters_.max_leaf &&
          !(best.cost + parameters_.traversal_cost * half_area(range.box) < leaf_cost(range))) {
        return false;
      }
      if (best.is_valid() && half_area(range.box) > 0) {
        const std::uint32_t middle = partition(range, map, best);
        left = {range.begin, middle, 1 - range.from, range.depth + 1, {}};
        right = {middle, range.end, 1 - range.from, range.depth + 1, {}};
        bins.sides(best, left.box, right.box);
        return true;
      }
    }
    if (n <= parameters_.max_leaf) return false;
    halve(range, left, right);
    return true;
  }

  Bounds centroid_bounds(const Range& range) const {
    const PrimRef* const refs = refs_[range.from].get();
    const auto bound = [refs](std::uint32_t first, std::uint32_t last) {
      Bounds box;
      for (std::uint32_t i = first; i < last; ++i) box.add(refs[i].centroid2());
      return box;
    };
    if (range.size() <= parallel_size) return bound(range.begin, range.end);
    std::vector<Bounds> parts((range.size() + chunk_size - 1) / chunk_size);
    for_chunks(range.begin, range.end, [&](std::uint32_t c, std::uint32_t first, std::uint32_t last) {
      parts[c] = bound(first, last);
    });
    Bounds box;
    for (const Bounds& part : parts) box.add(part);
    return box;
  }

  Bins fill_bins(const Range& range, const BinMap& map) const {
    const PrimRef* const refs = refs_[range.from].get();
    Bins bins(map.bins());
    if (range.size() <= parallel_size) {
      bins.add(map, refs + range.begin, refs + range.end);
      return bins;
    }
    std::vector<Bins> parts((range.size() + chunk_size - 1) / chunk_size, bins);
    for_chunks(range.begin, range.end, [&](std::uint32_t c, std::uint32_t first, std::uint32_t last) {
      parts[c].add(map, refs + first, refs + last);
    });
    for (const Bins& part : parts) bins.add(part);
    return bins;
  }

  /// Copies the range to the other array, left side upwards from its begin, right side downwards from its
  /// end.
  std::uint32_t partition(const Range& range, const BinMap& map, const Split& split) {
    const PrimRef* const from = refs_[range.from].get();
    PrimRef* const to = refs_[1 - range.from].get();
    const auto goes_left = [&](const PrimRef& ref) { return map.bin_on(split.axis, ref) < split.bin; };
    const auto scatter = [&](std::uint32_t first, std::uint32_t last, std::uint32_t left,
                             std::uint32_t right) {
      for (std::uint32_t i = first; i < last; ++i) {
        const bool is_left = goes_left(from[i]);
        to[is_left ? left : right] = from[i];
        left += is_left;
        right -= !is_left;
      }
      return left;
    };
    if (range.size() <= parallel_size) return scatter(range.begin, range.end, range.begin, range.end - 1);

    std::vector<std::uint32_t> lefts((range.size() + chunk_size - 1) / chunk_size);
    for_chunks(range.begin, range.end, [&](std::uint32_t c, std::uint32_t first, std::uint32_t last) {
      lefts[c] = static_cast<std::uint32_t>(std::count_if(from + first, from + last, goes_left));
    });
    std::uint32_t total = 0;
    for (std::uint32_t& count : lefts) count = std::exchange(total, total + count);
    for_chunks(range.begin, range.end, [&](std::uint32_t c, std::uint32_t first, std::uint32_t last) {
      const std::uint32_t rights = first - range.begin - lefts[c];
      scatter(first, last, range.begin + lefts[c], range.end - 1 - rights);
    });
    return range.begin + total;
  }

  /// Cuts by number, along the axis on which centroids spread most: for ranges that no plane divides, and
  /// where the depth limit comes near.
  void halve(const Range& range, Range& left, Range& right) {
    PrimRef* const refs = refs_[range.from].get();
    const Bounds centroids = centroid_bounds(range);
    const Vec3f extent = to_vec3(centroids.upper - centroids.lower);
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::uint32_t middle = range.begin + range.size() / 2;
    const auto key = [axis](const PrimRef& ref) {
      return std::pair(to_vec3(ref.centroid2())[axis], ref.id());
    };
    std::nth_element(refs + range.begin, refs + middle, refs + range.end,
                     [&](const PrimRef& a, const PrimRef& b) { return key(a) < key(b); });
    left = {range.begin, middle, range.from, range.depth + 1, {}};
    right = {middle, range.end, range.from, range.depth + 1, {}};
    for (Range* side : {&left, &right}) {
      for (std::uint32_t i = side->begin; i < side->end; ++i) side->box.add(refs[i].lower, refs[i].upper);
    }
  }

  /// Copies a subtree's pairs to their place in the whole tree, from `offset` on.
  void place(Subtree& subtree, BvhNode& root, BvhPair* pairs, std::size_t offset) {
    const auto shift = static_cast<std::uint32_t>(offset);
    root = subtree.root;
    if (!root.is_leaf()) root.first += shift;
    if (!subtree.child[0]) {
      for (BvhPair pair : subtree.pairs) {
        for (BvhNode& node : pair.child) node.first += node.is_leaf() ? 0 : shift;
        pairs[offset++] = pair;
      }
      subtree.pairs = {};
      return;
    }
    BvhPair& pair = pairs[offset];
    place(*subtree.child[0], pair.child[0], pairs, offset + 1);
    place(*subtree.child[1], pair.child[1], pairs, offset + 1 + subtree.child[0]->pair_count);
  }

  MeshView mesh_;
  BuildParameters parameters_;
  std::vector<PrimRef> given_refs_;  ///< or empty: the mesh's
  std::uint32_t count_;
  std::unique_ptr<PrimRef[]> refs_[2];
  std::uint32_t* primitives_ = nullptr;
};

}  // namespace

BinaryTree build_binary_tree(const MeshView& mesh, const BuildParameters& parameters) {
  if (mesh.count == 0) return {};
  return Builder(mesh, parameters).build();
}

BinaryTree build_binary_tree(std::vector<PrimRef> primitives, const BuildParameters& parameters) {
  return Builder(std::move(primitives), parameters).build();
}

}  // namespace castray
