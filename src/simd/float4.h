#pragma once

#include <emmintrin.h>

#include <cstdint>

namespace castray {

/// Four numbers in a register, for host code; SSE2, which every x86-64 has. Where an operand is not a number,
/// min and max return the second one.
struct Int4 {
  __m128i v;

  Int4() = default;  ///< of any value
  Int4(__m128i v) : v(v) {}
  explicit Int4(std::int32_t all) : v(_mm_set1_epi32(all)) {}
  /// `from` and `to` are aligned to 16 bytes.
  static Int4 load(const std::int32_t* from) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(from));
  }
  void store(std::int32_t* to) const { _mm_store_si128(reinterpret_cast<__m128i*>(to), v); }

  friend Int4 operator+(Int4 a, Int4 b) { return _mm_add_epi32(a.v, b.v); }
  friend Int4 operator>>(Int4 a, int bits) { return _mm_srli_epi32(a.v, bits); }
};

struct Float4 {
  __m128 v;

  Float4() = default;  ///< of any value
  Float4(__m128 v) : v(v) {}
  explicit Float4(float all) : v(_mm_set1_ps(all)) {}
  Float4(float x, float y, float z, float w) : v(_mm_setr_ps(x, y, z, w)) {}
  explicit Float4(Int4 i) : v(_mm_cvtepi32_ps(i.v)) {}
  /// `to` is aligned to 16 bytes.
  void store(float* to) const { _mm_store_ps(to, v); }

  Int4 truncated() const { return _mm_cvttps_epi32(v); }
  /// Bit l: lane l is above 0.
  int positive_lanes() const { return _mm_movemask_ps(_mm_cmpgt_ps(v, _mm_setzero_ps())); }

  /// With lanes x, y, z of this one and w as the bits of the fourth.
  Float4 with_w(std::uint32_t w) const {
    return _mm_or_ps(_mm_and_ps(v, xyz()), _mm_castsi128_ps(_mm_setr_epi32(0, 0, 0, static_cast<int>(w))));
  }
  Float4 without_w() const { return _mm_and_ps(v, xyz()); }
  std::uint32_t w_bits() const {
    return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_shuffle_epi32(_mm_castps_si128(v), 0xff)));
  }

  friend Float4 operator+(Float4 a, Float4 b) { return _mm_add_ps(a.v, b.v); }
  friend Float4 operator-(Float4 a, Float4 b) { return _mm_sub_ps(a.v, b.v); }
  friend Float4 operator*(Float4 a, Float4 b) { return _mm_mul_ps(a.v, b.v); }
  friend Float4 min(Float4 a, Float4 b) { return _mm_min_ps(a.v, b.v); }
  friend Float4 max(Float4 a, Float4 b) { return _mm_max_ps(a.v, b.v); }
  /// In each lane `yes` where a < b, else `no`.
  friend Float4 select_less(Float4 a, Float4 b, Float4 yes, Float4 no) {
    const __m128 less = _mm_cmplt_ps(a.v, b.v);
    return _mm_or_ps(_mm_and_ps(less, yes.v), _mm_andnot_ps(less, no.v));
  }
  friend void transpose(Float4& a, Float4& b, Float4& c, Float4& d) { _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v); }

 private:
  static __m128 xyz() { return _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0)); }
};

}  // namespace castray
