#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "castray/vec.h"

namespace castray {

/// A box with sides along the axes, in double. It begins empty.
struct Box3d {
  Vec3d lower{std::numeric_limits<double>::infinity()}, upper{-std::numeric_limits<double>::infinity()};

  void add(const Vec3d& p) {
    for (int i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], p[i]);
      upper[i] = std::max(upper[i], p[i]);
    }
  }
  std::array<Vec3d, 8> corners() const {
    std::array<Vec3d, 8> all;
    for (std::size_t i = 0; i < 8; ++i)
      all[i] = {(i & 1 ? upper : lower).x, (i & 2 ? upper : lower).y, (i & 4 ? upper : lower).z};
    return all;
  }
};

}  // namespace castray
