#pragma once

#include "simd/lanes.h"

namespace castray::CASTRAY_ISA {

/// Three components in each lane.
struct Vec {
  Float x, y, z;
};

CASTRAY_INLINE Vec broadcast(const float* p) { return {Float(p[0]), Float(p[1]), Float(p[2])}; }
CASTRAY_INLINE Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
CASTRAY_INLINE Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
CASTRAY_INLINE Vec operator*(Vec a, Vec b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
CASTRAY_INLINE Vec operator*(Vec a, Float s) { return {a.x * s, a.y * s, a.z * s}; }
CASTRAY_INLINE Vec operator-(Vec a) { return {-a.x, -a.y, -a.z}; }
CASTRAY_INLINE Float dot(Vec a, Vec b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
CASTRAY_INLINE Float length_squared(Vec a) { return dot(a, a); }
/// a + s * b
CASTRAY_INLINE Vec fma(Vec b, Float s, Vec a) {
  return {fma(b.x, s, a.x), fma(b.y, s, a.y), fma(b.z, s, a.z)};
}
/// a * b + c, component by component
CASTRAY_INLINE Vec fma_vec(Vec a, Vec b, Vec c) {
  return {fma(a.x, b.x, c.x), fma(a.y, b.y, c.y), fma(a.z, b.z, c.z)};
}
CASTRAY_INLINE Vec select(Mask m, Vec a, Vec b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
CASTRAY_INLINE Vec cross(Vec a, Vec b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}
CASTRAY_INLINE Vec magnitude(Vec a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
CASTRAY_INLINE Float sum_abs(Vec a) { return abs(a.x) + abs(a.y) + abs(a.z); }
CASTRAY_INLINE Float max_component(Vec a) { return max(a.x, max(a.y, a.z)); }
CASTRAY_INLINE Float luminance(Vec c) {
  return fma(c.x, Float(0.2126f), fma(c.y, Float(0.7152f), c.z * Float(0.0722f)));
}

/// Components in three arrays, one entry a lane.
template <int N>
struct VecArray {
  alignas(64) float x[N], y[N], z[N];
};

template <int N>
CASTRAY_INLINE Vec load(const VecArray<N>& a, int i) {
  return {load(a.x + i), load(a.y + i), load(a.z + i)};
}
template <int N>
CASTRAY_INLINE void store(VecArray<N>& a, int i, Vec v) {
  store(a.x + i, v.x);
  store(a.y + i, v.y);
  store(a.z + i, v.z);
}
template <int N>
CASTRAY_INLINE void compress_store(VecArray<N>& a, int i, Mask m, Vec v) {
  compress_store(a.x + i, m, v.x);
  compress_store(a.y + i, m, v.y);
  compress_store(a.z + i, m, v.z);
}
/// One entry in each lane.
template <int N>
CASTRAY_INLINE Vec gather_entries(const VecArray<N>& a, Uint i) {
  return {gather(a.x, i), gather(a.y, i), gather(a.z, i)};
}
/// The three floats that begin `offset` floats after `base`.
CASTRAY_INLINE Vec gather_vec(const float* base, Uint offset) {
  return {gather(base, offset), gather(base + 1, offset), gather(base + 2, offset)};
}
/// A field of three floats, of the records that begin `offset` floats after the table.
template <class Record>
CASTRAY_INLINE Vec gather_vec(const Record* table, float (Record::*field)[3], Uint offset) {
  return gather_vec(fields_of(table, field), offset);
}

inline constexpr float pi = 3.14159265358979f;

CASTRAY_INLINE Float square(Float x) { return x * x; }
CASTRAY_INLINE Vec black() { return {Float(0.f), Float(0.f), Float(0.f)}; }
CASTRAY_INLINE Vec normalize(Vec a) { return a * (Float(1.f) / sqrt(length_squared(a))); }

struct SinCos {
  Float sin, cos;
};

/// Sine and cosine of 2 pi u for u in [0,1], within 2^-22: reduced to an eighth of a turn, then Taylor
/// polynomials, whose remainders there are below 4e-8.
CASTRAY_INLINE SinCos sincos_turn(Float u) {
  const Uint quadrant = to_uint(fma(u, Float(4.f), Float(0.5f)));
  const Float x = fma(u, Float(4.f), -to_float(quadrant)) * Float(1.57079632679f);
  const Float x2 = x * x;
  const Float s =
      x * fma(x2, fma(x2, fma(x2, Float(-1.f / 5040), Float(1.f / 120)), Float(-1.f / 6)), Float(1.f));
  const Float c =
      fma(x2, fma(x2, fma(x2, fma(x2, Float(1.f / 40320), Float(-1.f / 720)), Float(1.f / 24)), Float(-0.5f)),
          Float(1.f));
  const Mask odd = (quadrant & 1u) == Uint(1u);
  const Float sine = select(odd, c, s), cosine = select(odd, s, c);
  return {as_float(as_uint(sine) ^ ((quadrant & 2u) << 30)),
          as_float(as_uint(cosine) ^ (((quadrant + 1u) & 2u) << 30))};
}

/// Two unit vectors that with the unit vector n form a right-handed orthogonal frame (Duff et al. 2017).
struct Frame {
  Vec s, t, n;
};
CASTRAY_INLINE Frame make_frame(Vec n) {
  const Float sign = copy_sign(Float(1.f), n.z);
  const Float a = Float(-1.f) / (sign + n.z);
  const Float b = n.x * n.y * a;
  return {
      {fma(sign * n.x, n.x * a, Float(1.f)), sign * b, -(sign * n.x)}, {b, fma(n.y, n.y * a, sign), -n.y}, n};
}
CASTRAY_INLINE Vec to_world(const Frame& f, Vec v) { return fma(f.s, v.x, fma(f.t, v.y, f.n * v.z)); }
CASTRAY_INLINE Vec to_local(const Frame& f, Vec v) { return {dot(v, f.s), dot(v, f.t), dot(v, f.n)}; }

}  // namespace castray::CASTRAY_ISA
