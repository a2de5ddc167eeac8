#pragma once

#include "geometry/instance_records.h"
#include "simd/vec_lanes.h"

namespace castray::CASTRAY_ISA {

/// Matrices and translations of instances, and points and directions mapped by them.
struct InstanceLanes {
  Vec to_scene[3], to_object[3], translation;

  CASTRAY_INLINE InstanceLanes(const KernelInstance* instances, Uint instance) {
    const Uint at = instance * instance_floats;
    const float* const table = (const float*)instances;
    for (uint32_t i = 0; i < 3; ++i) {
      to_scene[i] = gather_vec(table, at + 3 * i);
      to_object[i] = gather_vec(table, at + 9 + 3 * i);
    }
    translation = gather_vec(table, at + 18);
  }

  static CASTRAY_INLINE Vec product(const Vec (&rows)[3], const Vec& v) {
    return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)};
  }
  /// |rows| v, of a v without negative components.
  static CASTRAY_INLINE Vec spread(const Vec (&rows)[3], const Vec& v) {
    return {dot(magnitude(rows[0]), v), dot(magnitude(rows[1]), v), dot(magnitude(rows[2]), v)};
  }
};

}  // namespace castray::CASTRAY_ISA
