#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "castray/vec.h"

namespace castray {

/// Linear radiance, float RGB, top row first.
struct Image {
  int width = 0, height = 0;
  std::vector<Vec3f> pixels;

  Image() = default;
  Image(int w, int h)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  Vec3f& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  const Vec3f& at(int x, int y) const { return const_cast<Image*>(this)->at(x, y); }
};

}  // namespace castray
