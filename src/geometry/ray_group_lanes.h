#pragma once

#include "geometry/wide_bvh_view.h"
#include "simd/lanes.h"

namespace castray::CASTRAY_ISA {

constexpr uint32_t group_size = 128;

/// Rays prepared for boxes and triangles, each number of all rays side by side. The numerics are those of
/// geometry/slab.h and geometry/triangle.h.
struct RayGroup {
  alignas(64) float inverse[3][group_size];  // t = plane * inverse - offset
  float near_offset[3][group_size], far_offset[3][group_size];
  float origin[3][group_size], direction_z[group_size];  // along the ray's own axes x, y and z, the longest
  float shear_x[group_size], shear_y[group_size];
  float nearest[group_size];           // the greatest t that is still of interest, inclusive
  uint32_t near_plane[3][group_size];  // of a node's planes, in bytes from its start
  uint32_t axis[3][group_size];        // x, y, z of a packet's coordinates, in bytes
  uint32_t octant[group_size];
  uint32_t traceable[group_size];
};

/// Bytes from a node's near plane on axis i to its far plane, by exclusive or.
constexpr uint32_t far_plane_flip[3] = {0x60, 0xa0, 0xe0};

/// What a tree's boxes are to be grown by for rounding that SlabTest does not know of, over the distance to
/// the farthest plane.
struct NoSlack {
  CASTRAY_INLINE Float operator()(Float grow, const Float (&)[3]) const { return grow; }
};
struct Slack {
  float share;
  CASTRAY_INLINE Float operator()(Float grow, const Float (&reach)[3]) const {
    return grow + max(reach[0], max(reach[1], reach[2])) * Float(share);
  }
};

/// Fills lanes [first, first + width) of the group: what SlabTest and TriangleTest do when made.
template <class AnySlack = NoSlack>
CASTRAY_INLINE void prepare(RayGroup& group, uint32_t first, const WideBvhView& bvh, const Float (&o)[3],
                            const Float (&d)[3], Float t_max, const AnySlack& slack = {}) {
  constexpr float half_ulp = 0x1p-24f;
  const Float size = max(abs(d[0]), max(abs(d[1]), abs(d[2])));
  const Float place = max(abs(o[0]), max(abs(o[1]), abs(o[2])));
  const Float sum =
      (abs(d[0]) + abs(d[1]) + abs(d[2])) * (abs(o[0]) + abs(o[1]) + abs(o[2]));  // NaN if any is
  const Mask traceable = (size >= Float(0x1p-60f)) & (size <= Float(0x1p60f)) & (place <= Float(0x1p34f)) &
                         (sum <= Float(__builtin_inff())) & (t_max > Float(0.0f));
  store(group.traceable + first, select(traceable, Uint(1u), Uint(0u)));

  const Mask x_over_y = abs(d[0]) > abs(d[1]);
  const Mask z_is_x = x_over_y & (abs(d[0]) > abs(d[2]));
  const Mask z_is_y = ~x_over_y & (abs(d[1]) > abs(d[2]));
  const auto along_x = [&](auto a, auto b, auto c) { return select(z_is_x, b, select(z_is_y, c, a)); };
  const auto along_y = [&](auto a, auto b, auto c) { return select(z_is_x, c, select(z_is_y, a, b)); };
  const auto along_z = [&](auto a, auto b, auto c) { return select(z_is_x, a, select(z_is_y, b, c)); };
  const Float direction_z = along_z(d[0], d[1], d[2]);
  store(group.origin[0] + first, along_x(o[0], o[1], o[2]));
  store(group.origin[1] + first, along_y(o[0], o[1], o[2]));
  store(group.origin[2] + first, along_z(o[0], o[1], o[2]));
  store(group.direction_z + first, direction_z);
  store(group.shear_x + first, along_x(d[0], d[1], d[2]) / direction_z);
  store(group.shear_y + first, along_y(d[0], d[1], d[2]) / direction_z);
  store(group.nearest + first, as_float(as_uint(t_max) - Uint(1u)));  // below t_max, as that is positive
  constexpr uint32_t row = packet_size * sizeof(float);
  store(group.axis[0] + first, along_x(Uint(0u), Uint(row), Uint(2 * row)));
  store(group.axis[1] + first, along_y(Uint(0u), Uint(row), Uint(2 * row)));
  store(group.axis[2] + first, along_z(Uint(0u), Uint(row), Uint(2 * row)));

  Float reach[3];
  for (int i = 0; i < 3; ++i)
    reach[i] = max(abs(Float(bvh.lower[i]) - o[i]), abs(Float(bvh.upper[i]) - o[i]));
  const Float reach_t = along_z(reach[0], reach[1], reach[2]) / size;
  Uint octant(0u);
  for (int i = 0; i < 3; ++i) {
    // A component this small moves the ray by less than the boxes have grown: a finite reciprocal will do.
    const Float inverse = Float(1.0f) / copy_sign(max(abs(d[i]), size * Float(0x1p-32f)), d[i]);
    // As SlabTest, but 2 gamma(3) of the distance to the farthest plane instead of to each: one reciprocal.
    const Float grow =
        copy_sign(slack(Float(9 * half_ulp) * reach[i] + Float(4 * half_ulp) * abs(o[i]) +
                            Float(17 * half_ulp) * max(abs(d[i]), size * Float(0x1p-8f)) * reach_t,
                        reach),
                  d[i]);
    store(group.inverse[i] + first, inverse);
    store(group.near_offset[i] + first, (o[i] + grow) * inverse);
    store(group.far_offset[i] + first, (o[i] - grow) * inverse);
    const Uint negative = as_uint(d[i]) >> 31;
    constexpr uint32_t plane = bvh_width * sizeof(float);
    store(group.near_plane[i] + first, Uint((uint32_t)i * plane) + negative * Uint(3 * plane));
    octant = octant | (negative << i);
  }
  store(group.octant + first, octant);
}

/// Fills the group with rays first .. first + count - 1 of a batch.
template <class Batch, class AnySlack = NoSlack>
CASTRAY_INLINE void prepare_rays(RayGroup& group, const WideBvhView& bvh, const Batch& rays, uint32_t first,
                                 uint32_t count, const AnySlack& slack = {}) {
  const uint32_t last = first + count;
  for (uint32_t i = first; i < last; i += width) {
    const Float o[3] = {load_padded(rays.ox, i, last), load_padded(rays.oy, i, last),
                        load_padded(rays.oz, i, last)};
    const Float d[3] = {load_padded(rays.dx, i, last), load_padded(rays.dy, i, last),
                        load_padded(rays.dz, i, last)};
    prepare(group, i - first, bvh, o, d, load_padded(rays.t_max, i, last), slack);
  }
}

}  // namespace castray::CASTRAY_ISA
