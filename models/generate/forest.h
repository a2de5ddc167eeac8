#pragma once

#include <vector>

#include "generate/shapes.h"

namespace castray {

/// A broad-leaved tree about ten units high that stands on the origin.
struct Tree {
  Shape wood, leaves;
};
/// Of about `triangles`, a fifth of them wood.
Tree make_tree(std::uint32_t triangles, std::uint32_t seed);

/// A tree of a forest: turned about y by `turn` radians, times `size`, moved to `foot`.
struct TreePlace {
  Vec3d foot;
  double turn, size;
};

/// Places on a hilly ground, about one for every 25 square units, in a square around the origin.
std::vector<TreePlace> make_places(std::uint32_t trees, std::uint32_t seed);

/// The ground under so many trees and a margin around them.
Shape make_ground(std::uint32_t trees);

}  // namespace castray
