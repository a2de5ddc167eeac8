#pragma once

#include "castray/image.h"
#include "generate/shapes.h"

namespace castray {

/// A crown of leaves, each a square of two triangles with texture coordinates, of which leaf_mask shows what
/// is leaf: 2 triangles a leaf. For the same number of leaves the same leaves as cut_leaves.
Shape masked_leaves(std::uint32_t leaves, std::uint32_t seed);

/// The same leaves, cut out: triangles_of_cut_leaf a leaf.
Shape cut_leaves(std::uint32_t leaves, std::uint32_t seed);
inline constexpr std::uint32_t triangles_of_cut_leaf = 8;

/// 1 inside a leaf's outline, 0 outside; the share of the texel that is inside on its edge. `size` x `size`.
Image leaf_mask(int size);

}  // namespace castray
