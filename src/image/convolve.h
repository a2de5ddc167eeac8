#pragma once

#include <functional>
#include <vector>

#include "castray/image.h"

namespace castray {

/// One number a pixel, top row first.
struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;

  Plane(int w, int h)
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  float& at(int x, int y) {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  float at(int x, int y) const { return const_cast<Plane*>(this)->at(x, y); }
};

/// Component c of every pixel.
Plane plane_of(const Image& image, int c);

/// Weights of offsets -radius .. radius.
using Taps = std::vector<double>;

/// The weights f(offset) for offsets -radius .. radius.
Taps make_taps(int radius, const std::function<double(int)>& f);
/// The same, divided by their sum.
Taps normalised(Taps taps);

/// What a filter sees beyond the image's edge.
enum class Border : unsigned char {
  clamp,  ///< the nearest pixel of the edge
  cut,    ///< nothing: the weights inside are scaled to the sum of all
};

/// Each value replaced by the sum of weight times value at the offset, first along rows, then along columns.
Plane convolve(const Plane& plane, const Taps& along_x, const Taps& along_y, Border border);

}  // namespace castray
