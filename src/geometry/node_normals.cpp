#include "geometry/node_normals.h"

#include <algorithm>
#include <cmath>

namespace castray {
namespace {

/// A ball that holds the unit normals of triangles.
struct NormalBall {
  Vec3d center;
  double radius = 0;
  bool in_surface = true;  ///< all of them are in the closed surface
};

/// The unit normal of a triangle of a packet; one without area has any.
NormalBall ball_of(const TrianglePacket& packet, int lane, const ClosedSurface& surface) {
  const auto corner = [&](int v) {
    return Vec3d(packet.vertex[v][0][lane], packet.vertex[v][1][lane], packet.vertex[v][2][lane]);
  };
  const Vec3d a = corner(0), normal = cross(corner(1) - a, corner(2) - a);
  const double size = length(normal);
  const bool in_surface = surface.has[packet.triangle[lane]];
  return size > 0 ? NormalBall{normal / size, 0, in_surface} : NormalBall{Vec3d(), 1, in_surface};
}

NormalBall around(const NormalBall* balls, int count) {
  NormalBall all;
  for (int i = 0; i < count; ++i) {
    all.center = all.center + balls[i].center / count;
    all.in_surface = all.in_surface && balls[i].in_surface;
  }
  for (int i = 0; i < count; ++i)
    all.radius = std::max(all.radius, length(balls[i].center - all.center) + balls[i].radius);
  all.radius = std::min(all.radius, 1 + length(all.center));  // farther away there is no unit vector
  return all;
}

class NormalBounder {
 public:
  NormalBounder(WideTree& tree, const ClosedSurface& surface)
      : blocks_(tree.blocks.data()), surface_(surface) {}

  NormalBall bound(std::uint32_t child, int threads) const {
    char* const at = blocks_ + std::size_t{child / child_unit} * block_bytes;
    if (child & leaf_flag)
      return bound_leaf(reinterpret_cast<const TrianglePacket*>(at), child % max_leaf_packets + 1);
    WideNode& node = *reinterpret_cast<WideNode*>(at);
    NormalBall balls[bvh_width];
    int count = 0;
    while (count < bvh_width && node.lower[0][count] <= node.upper[0][count]) ++count;
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (int slot = 0; slot < count; ++slot) {
      balls[slot] = bound(node.child[slot], 1);
      keep(balls[slot], node, slot);
    }
    return around(balls, count);
  }

 private:
  NormalBall bound_leaf(const TrianglePacket* packet, std::uint32_t packets) const {
    NormalBall balls[packet_size * max_leaf_packets];
    int count = 0;
    for (std::uint32_t k = 0; k < packets; ++k)
      for (int lane = 0; lane < packet_size; ++lane) balls[count++] = ball_of(packet[k], lane, surface_);
    return around(balls, count);
  }

  static void keep(const NormalBall& ball, WideNode& node, int slot) {
    if (!ball.in_surface) return;
    constexpr double rounding = 2;  // above half a unit on each of three axes
    for (int axis = 0; axis < 3; ++axis)
      node.normal[axis][slot] = static_cast<std::int16_t>(std::lround(ball.center[axis] / normal_unit));
    node.spread[slot] = static_cast<std::uint16_t>(std::ceil(ball.radius / normal_unit + rounding));
  }

  char* const blocks_;
  const ClosedSurface& surface_;
};

}  // namespace

void bound_normals(WideTree& tree, const ClosedSurface& surface, int threads) {
  NormalBounder(tree, surface).bound(tree.root, threads);
}

}  // namespace castray
