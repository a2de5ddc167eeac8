#pragma once

#include "bench/noise_free.h"
#include "bench/report.h"

namespace castray {

/// A square window, a quarter of the image wide, where the pictures at equal time differ most from the
/// reference, taken together and relative to it; emitters, if masked, do not decide.
Window worst_window(const BenchScene& scene, const PixelMask& mask);

/// The part of `image` that `window` shows.
Image cropped(const Image& image, const Window& window);

}  // namespace castray
