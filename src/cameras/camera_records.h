#pragma once

namespace castray {

/// Sample (px,py) of the full image looks along corner + px * dx + py * dy.
struct KernelCamera {
  float position[3];
  float corner[3], dx[3], dy[3];
};

}  // namespace castray
