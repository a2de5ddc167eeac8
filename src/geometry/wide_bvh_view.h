#pragma once

#include <stdint.h>

// A wide bounding volume hierarchy as kernels read it: plain data, the same for every instruction set.

namespace castray {

inline constexpr int bvh_width = 8;    ///< children of a node
inline constexpr int packet_size = 8;  ///< triangles tested at once

/// Nodes and triangle packets lie in one array of blocks, a cache line each. A child is its first block times
/// child_unit, plus leaf_flag + packets - 1 if it is a leaf.
inline constexpr uint32_t block_bytes = 64;
inline constexpr uint32_t child_unit = 8;
inline constexpr uint32_t leaf_flag = 4;
inline constexpr uint32_t max_leaf_packets = 4;

/// Unit of WideNode::normal and spread.
inline constexpr float normal_unit = 0x1p-14f;
/// WideNode::spread of children that are not wholly of a closed surface.
inline constexpr uint16_t no_surface = 0xffff;

/// Eight children: their boxes, plane by plane, and which way they face.
struct alignas(block_bytes) WideNode {
  float lower[3][bvh_width];  ///< an unused slot holds the empty box, +infinity to -infinity
  float upper[3][bvh_width];
  uint32_t child[bvh_width];
  uint32_t order[8];  ///< for each octant of directions (bit i: component i is negative), the slots from the
                      ///< farthest to the nearest, four bits each, the farthest lowest
  int16_t normal[3][bvh_width];  ///< centre and radius of a ball that holds the unit normals of all triangles
  uint16_t spread[bvh_width];    ///< below the child, in normal_unit; or no_surface
};

/// Eight triangles, vertex by vertex and axis by axis, exactly as in the mesh. Unused lanes go along the
/// first triangle's first edge and back: two edge functions are each other's negative, and no ray hits.
struct alignas(block_bytes) TrianglePacket {
  float vertex[3][3][packet_size];
  uint32_t triangle[packet_size];
};

struct WideBvhView {
  const char* blocks;
  uint32_t root;  ///< as a child; meaningless without triangles
  uint32_t triangles;
  int depth;                 ///< edges from the root to its deepest leaf
  float lower[3], upper[3];  ///< of everything
};

}  // namespace castray
