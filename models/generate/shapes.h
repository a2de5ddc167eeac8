#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "castray/scene.h"
#include "castray/vec.h"

namespace castray {

/// A mesh made by rule, the same for the same arguments. All lie in [-1,1]^3; closed ones have their
/// counter-clockwise side outside.
struct Shape {
  std::vector<Vec3d> positions;
  std::vector<Index3> triangles;
  std::vector<std::array<float, 2>> uvs{};  ///< of the positions, or none
  std::vector<Vec3d> normals{};             ///< likewise
};

/// The unit sphere: an icosahedron whose edges are cut in `frequency`; 20 frequency^2 triangles.
Shape icosphere(std::uint32_t frequency);

/// The same with the sphere's normals at its corners.
Shape smooth_icosphere(std::uint32_t frequency);

/// An icosphere with smooth bumps and hollows: closed, not convex.
Shape blob(std::uint32_t frequency, std::uint32_t seed);

/// A tube along a (2,3) torus knot: 2 * along * around triangles, closed.
Shape torus_knot(std::uint32_t along, std::uint32_t around);

/// Fractal hills over the square y = 0, facing +y; exactly `triangles` of them.
Shape terrain(std::uint32_t triangles, std::uint32_t seed);

/// Curved strands, each a ribbon of 16 slivers about 500 times as long as wide, on a ball.
Shape hair(std::uint32_t triangles, std::uint32_t seed);

/// Small triangles of any direction anywhere in the cube.
Shape soup(std::uint32_t triangles, std::uint32_t seed);

/// Long thin triangles from anywhere to anywhere in the cube: their boxes fill it many times over.
Shape sticks(std::uint32_t triangles, std::uint32_t seed);

/// The shape of that name (icosphere, smooth_icosphere, blob, torus_knot, terrain, hair, soup, sticks,
/// masked_leaves, cut_leaves) with about `triangles` triangles. Throws InputError where there is none.
Shape make_shape(std::string_view name, std::uint32_t triangles, std::uint32_t seed);

}  // namespace castray
