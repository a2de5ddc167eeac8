#pragma once

#include <cstdint>
#include <vector>

#include "castray/film.h"
#include "wavefront/kernel_scene.h"

namespace castray {

/// Which pixels of a window, and as far around it as its tiles reach, see more than one surface: what a
/// sample of theirs brings depends on which of them it hits. Found by rays through the pixels' corners, so
/// that it is the same for all samples; a surface that lies between the corners is missed.
class PixelEdges {
 public:
  PixelEdges() = default;
  PixelEdges(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data, const Window& window,
             int threads);

  EdgeTable table() const { return {kinds_.data(), x0_, y0_, width_}; }
  /// Whether any pixel with x0 <= x < x1, y0 <= y < y1 of those that the table has sees one.
  bool any(int x0, int y0, int x1, int y1) const;
  /// Whether pixel (x,y) of the window sees the outline of a lamp.
  bool of_lamp(int x, int y) const { return kinds_[place(x, y)] == lamp_edge; }

 private:
  enum Kind : std::uint8_t { smooth = 0, edge = 1, lamp_edge = 3 };  ///< as in EdgeTable

  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y - y0_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x - x0_);
  }

  int x0_ = 0, y0_ = 0, width_ = 0;
  std::vector<std::uint8_t> kinds_;  ///< Kind
};

}  // namespace castray
