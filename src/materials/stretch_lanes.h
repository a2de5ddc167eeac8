#pragma once

#include "geometry/placement_lanes.h"
#include "materials/normals_lanes.h"

// How lobes that are not round lie on a surface: along a direction in the plane of the triangle, at an
// angle from the one in which u grows, and along what that is in the plane across the shading normal, seen
// along it.

namespace castray::CASTRAY_ISA {

/// slot_stretch for lobes of this strength in a frame with this normal, wide along `along`. Doubled angles
/// have no sense of direction.
struct Stretch {
  Float x, y;
};
CASTRAY_INLINE Stretch stretch_along(const Frame& frame, const Vec& along, Float strength) {
  const Float x = dot(along, frame.s), y = dot(along, frame.t), scale = strength / fma(x, x, y * y);
  return {fma(x, x, -(y * y)) * scale, Float(2.f) * x * y * scale};
}

/// How lobes lie before the shading normal is known: how far from round they are, and cosine and sine of the
/// angle from where u grows to where they are wide.
struct Lie {
  Float strength, x, y;
};

/// Sets what images say of it. `value`: of the points, in which resolve_values leaves strengths.
inline __attribute__((noinline)) void lie_by_images(const MaterialTables& tables, const TriangleTable& table,
                                                    const Uint& material, const TrianglePlace& at,
                                                    const Mask& stretched, const Float* value, Lie& lie) {
  const MapInputs in = map_inputs(table, at);
  for_each_detail(tables, material, stretched & in.has_uv, [&](const KernelDetail& d, const Mask& here) {
    if (d.stretch_slot) lie.strength = select(here, value[d.stretch_slot], lie.strength);
    if (d.turn) {
      const SinCos turn = sincos_turn(fraction(map_value(*d.turn, in.u, in.v).x));
      lie.x = select(here, turn.cos, lie.x);
      lie.y = select(here, turn.sin, lie.y);
    }
    if (d.direction) {
      const Vec w = map_normal(*d.direction, in.u, in.v);
      const Mask turns = here & (fma(w.x, w.x, w.y * w.y) > Float(least_direction2));
      const Float x = fma(lie.x, w.x, -(lie.y * w.y)), y = fma(lie.y, w.x, lie.x * w.y);
      lie.x = select(turns, x, lie.x);
      lie.y = select(turns, y, lie.y);
    }
  });
}

/// Lays the lobes of materials that have such ones: sets `value`'s slot_stretch, or slot_layered_stretch, for
/// the frame of the shading normal, which is on the viewer's side as `facing` is. `front`: that is the
/// geometric normal's side.
template <class Placement>
__attribute__((noinline)) void lay_lobes(const MaterialTables& tables, const TriangleTable& table,
                                         const Placement& placement, const Uint& material,
                                         const TrianglePlace& at, const Mask& front, const Vec& facing,
                                         const Vec& shading_normal, Float* value) {
  const Mask stretched = has_traits(tables, material, trait_stretched);
  if (none(stretched)) return;
  const Vec outward = select(front, facing, -facing);
  Vec u = make_frame(outward).s;
  Float handedness(1.f);
  if (table.uv_corners) {
    const UvDerivatives d = uv_derivatives(table, placement, at.triangle);
    u = select(d.valid, normalize(d.du), u);
    handedness = select(d.valid, d.handedness, handedness);
  }
  const float* turn = fields_of(tables.materials, &KernelMaterial::turn);
  Lie lie{gather(tables.materials, &KernelMaterial::stretch, material), gather(turn, material),
          gather(turn + 1, material)};
  if (tables.stretched_by_images) lie_by_images(tables, table, material, at, stretched, value, lie);
  const Vec v = cross(outward, u) * handedness, along = fma(v, lie.y, u * lie.x);
  const Stretch laid = stretch_along(make_frame(shading_normal), along, lie.strength);
  const Mask metal =
      gather(tables.materials, &KernelMaterial::type, material) == Uint((uint32_t)MaterialType::conductor);
  const auto set = [&](const Mask& lanes, int slot) {
    value[slot] = select(lanes, laid.x, value[slot]);
    value[slot + 1] = select(lanes, laid.y, value[slot + 1]);
  };
  set(stretched & metal, slot_stretch);
  set(stretched & ~metal, slot_layered_stretch);
}

/// Lays the lobes of `b`, which lie as the shading normal `from` has it, as `to` has it, in `lanes`.
/// `normal`: the geometric one.
inline __attribute__((noinline)) void relay_lobes(const Mask& lanes, const Vec& from, const Vec& to,
                                                  const Vec& normal, Bsdf& b) {
  const Float strength = sqrt(fma(b.stretch[0], b.stretch[0], b.stretch[1] * b.stretch[1]));
  const Mask stretched = lanes & (strength > Float(0.f));
  if (none(stretched)) return;
  const Float cos2 = b.stretch[0] / strength, half(0.5f);
  const Float c = sqrt(max(fma(cos2, half, half), Float(0.f)));
  const Float s = copy_sign(sqrt(max(fma(cos2, -half, half), Float(0.f))), b.stretch[1]);
  const Frame before = make_frame(from);
  const Vec across = fma(before.t, s, before.s * c);
  const Vec along = across - from * (dot(across, normal) / dot(from, normal));
  const Stretch laid = stretch_along(make_frame(to), along, strength);
  b.stretch[0] = select(stretched, laid.x, b.stretch[0]);
  b.stretch[1] = select(stretched, laid.y, b.stretch[1]);
}

}  // namespace castray::CASTRAY_ISA
