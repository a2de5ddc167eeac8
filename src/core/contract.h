#pragma once

#include <stdint.h>

// What all integrators agree on: the numbers that place a path in the random sequence, hash it, and end it.
// Included by host code and by kernels. Kernels are compiled once for each instruction set, so this file
// holds constants and functions that are always inlined, and includes no library: a shared function could be
// linked from the wrong set.
//
// Functions of U work on uint32_t and on the kernels' lanes of it alike.

namespace castray {

#define CASTRAY_CONTRACT [[gnu::always_inline]] constexpr

// Random numbers (core/sequences.h).

/// Sobol' points of one scramble: 2^index_bits. Sample index >> index_bits is the epoch; each epoch has a
/// scramble of its own.
inline constexpr int index_bits = 20;

/// The blocks of four random numbers that a path uses.
struct PathBlocks {
  /// Position in the pixel (2), light point of the first vertex (2).
  static constexpr uint32_t camera = 0;
  /// Point on the lens (2), for a camera that has one.
  static constexpr uint32_t lens = 0xffffffffu;
  /// The same where vertex k of a path from a light is seen.
  CASTRAY_CONTRACT static uint32_t lens_of_light_path(uint32_t vertex) { return lens - vertex; }
  /// At vertex k >= 0 (0 is the camera's hit): direction (2), light point of vertex k + 1 (2).
  CASTRAY_CONTRACT static uint32_t direction(uint32_t vertex) { return 1 + 2 * vertex; }
  /// At vertex k: direction to an environment that is sampled (2), light without size, spare.
  CASTRAY_CONTRACT static uint32_t environment(uint32_t vertex) { return 0x80000000u + vertex; }
  /// At vertex k: roulette, lobe, light, spare.
  CASTRAY_CONTRACT static uint32_t choice(uint32_t vertex) { return 2 + 2 * vertex; }
};

/// A 32-bit finaliser of low bias (Wellons' "lowbias32").
template <class U>
CASTRAY_CONTRACT U hash32(U x) {
  x = x ^ (x >> 16);
  x = x * 0x7feb352du;
  x = x ^ (x >> 15);
  x = x * 0x846ca68bu;
  return x ^ (x >> 16);
}

template <class U>
CASTRAY_CONTRACT U hash_combine(U a, U b) {
  return hash32(a ^ (b * 0x9e3779b9u + 0x7f4a7c15u));
}

/// The seed of dimension d < 4 of a block's scramble, from the block's seed.
template <class U>
CASTRAY_CONTRACT U dimension_seed(U seed, int d) {
  constexpr uint32_t factor[4] = {0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du, 0x27d4eb2fu};
  const U v = seed * factor[d];
  return v ^ (v >> 16);
}

/// Nested uniform scramble (Owen 1995) of bit-reversed v: every bit depends on the lower ones only. After
/// Laine and Karras 2011, section 3, with the constants that pbrt-v4 uses.
template <class U>
CASTRAY_CONTRACT U owen_hash(U v, U seed) {
  v = v ^ (v * 0x3d20adeau);
  v = v + seed;
  v = v * ((seed >> 16) | 1u);
  v = v ^ (v * 0x05526c56u);
  return v ^ (v * 0x53a22864u);
}

// Partial coverage.

/// The world of a path of its own: that of this sample of the pixel with this key.
CASTRAY_CONTRACT uint32_t path_world(uint32_t key, uint64_t sample) {
  return hash_combine(hash_combine(key, static_cast<uint32_t>(sample)), static_cast<uint32_t>(sample >> 32));
}

/// Of a point of a triangle in a world; b1 and b2 by their bits.
template <class U>
CASTRAY_CONTRACT U point_hash(U world, U triangle, U b1, U b2) {
  return hash_combine(hash_combine(hash_combine(world, triangle), b1), b2);
}

/// What decides, against the coverage there, whether a point of a triangle is there in a world.
CASTRAY_CONTRACT float presence_number(uint32_t world, uint32_t triangle, float b1, float b2) {
  const uint32_t hash =
      point_hash(world, triangle, __builtin_bit_cast(uint32_t, b1), __builtin_bit_cast(uint32_t, b2));
  return static_cast<float>(hash >> 8) * 0x1p-24f;
}

/// The world that decides which points are glass, independently of those that are there.
template <class U>
CASTRAY_CONTRACT U glass_world(U world) {
  return hash_combine(world, U(0x61a55u));
}

/// What decides, against the share, whether a point of a triangle is glass in a world.
CASTRAY_CONTRACT float glass_number(uint32_t world, uint32_t triangle, float b1, float b2) {
  return presence_number(glass_world(world), triangle, b1, b2);
}

// Russian roulette.

/// By throughput it starts at this vertex; earlier it saves less time than it adds noise.
inline constexpr uint32_t first_roulette_vertex = 2;
/// The survival probability by throughput is at most this, so that paths between white walls end.
inline constexpr double highest_survival = 0.95;
/// From this vertex on a fixed survival probability has the same bound, so that time and recursion have one.
inline constexpr uint32_t first_capped_vertex = 1000;

// Choices that depend on the scene.

/// Kernels are compiled for sets of these; what a scene does not need is not in its kernel.
enum KernelFeature : uint32_t {
  feature_bvh = 1,        ///< a tree instead of a flat list
  feature_materials = 2,  ///< other than diffuse
  feature_detail = 4,     ///< textures and smooth normals
  feature_instances = 8,  ///< a tree over instances of objects, which have trees of their own
};
inline constexpr uint32_t kernel_feature_sets = 16;

/// Up to so many triangles a flat list is faster than a tree.
inline constexpr uint32_t longest_list = 64;

#undef CASTRAY_CONTRACT

}  // namespace castray
