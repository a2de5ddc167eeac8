#include "geometry/node_normals.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <new>

#include "geometry/wide_bvh_view.h"

using namespace castray;

namespace {

constexpr std::uint32_t node_blocks = sizeof(WideNode) / block_bytes,
                        packet_blocks = sizeof(TrianglePacket) / block_bytes;

/// Of triangles whose unit normals are all (0, 0, z).
TrianglePacket packet_facing(float z) {
  TrianglePacket packet{};
  for (int lane = 0; lane < packet_size; ++lane) {
    packet.vertex[1][0][lane] = 1;
    packet.vertex[2][1][lane] = z;
  }
  return packet;
}

/// A chain of nodes: the first child of each is the next one, its others are leaves that face up and down by
/// turns. At the end all children are leaves.
WideTree chain(std::uint32_t nodes) {
  const std::uint32_t leaves = nodes * node_blocks;
  WideTree tree{BlockArray((leaves + 2 * packet_blocks) * std::size_t{block_bytes}), nodes, 0, int(nodes)};
  for (std::uint32_t n = 0; n < nodes; ++n) {
    auto* node = new (tree.blocks.data() + std::size_t{n} * sizeof(WideNode)) WideNode{};
    const std::uint32_t leaf = (leaves + n % 2 * packet_blocks) * child_unit + leaf_flag;
    for (std::uint32_t& child : node->child) child = leaf;
    if (n + 1 < nodes) node->child[0] = (n + 1) * node_blocks * child_unit;
  }
  for (std::uint32_t k = 0; k < 2; ++k)
    new (tree.blocks.data() + (leaves + k * packet_blocks) * std::size_t{block_bytes})
        TrianglePacket(packet_facing(k == 0 ? 1 : -1));
  return tree;
}

}  // namespace

TEST_CASE("the normals below a node are in its ball, in trees of any depth") {
  constexpr std::uint32_t nodes = 12;
  WideTree tree = chain(nodes);
  bound_normals(tree, {{true}, {}}, 1);
  for (std::uint32_t n = 0; n + 1 < nodes; ++n) {
    const auto& node =
        *reinterpret_cast<const WideNode*>(tree.blocks.data() + std::size_t{n} * sizeof(WideNode));
    const float center = float(node.normal[2][0]) * normal_unit, radius = float(node.spread[0]) * normal_unit;
    INFO("node " << n);
    CHECK(radius >= std::abs(-1 - center));
    CHECK((n + 2 == nodes || radius >= std::abs(1 - center)));
    CHECK(radius < 2.001f);
  }
}
