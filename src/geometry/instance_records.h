#pragma once

#include <stdint.h>

#include "geometry/wide_bvh_view.h"

// Instances of objects as kernels read them: plain data, the same for every instruction set.

namespace castray {

/// An object at its place: p of its space is at to_scene . p + translation.
struct KernelInstance {
  float to_scene[3][3];   ///< by rows
  float to_object[3][3];  ///< the inverse, rounded
  float translation[3];
  uint32_t object;  ///< into InstanceTree::objects
};
inline constexpr uint32_t instance_floats = sizeof(KernelInstance) / sizeof(float);

/// The tree of an object's triangles, in its space.
struct KernelObject {
  WideBvhView bvh;
  uint32_t first;  ///< its first triangle, of all triangles
};

/// All of a scene as a tree over instances of objects. Triangles in scene space are an object too, whose
/// instance is the last and maps by the identity: a hit there is on instance `plain`.
///
/// Rays enter an object's tree in its space, as o' + t d' with the same t: so nearness is compared across
/// objects, and the triangles of an object are as watertight as without instances.
struct InstanceTree {
  WideBvhView top;  ///< a leaf is child_unit times an instance, plus leaf_flag
  const KernelObject* objects;
  const KernelInstance* instances;
  uint32_t count;  ///< of instances
  uint32_t plain;  ///< `count` if nothing is in scene space
  int depth;       ///< of `top` and the deepest object together
  /// Bounds how far, over its distance from a ray's origin, rounding the ray to an object's space and testing
  /// a triangle there may move a point in scene space, per coordinate.
  float slack;
};

}  // namespace castray
