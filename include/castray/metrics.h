#pragma once

#include <string>
#include <utility>
#include <vector>

#include "castray/image.h"

namespace castray {

/// How an image x differs from a reference r, over all pixels and the three channels.
struct ErrorMetrics {
  double mse = 0;            ///< mean of (x-r)^2
  double rmse = 0;           ///< sqrt(mse)
  double relmse = 0;         ///< mean of (x-r)^2 / (r^2 + 0.01)
  double mae = 0;            ///< mean of |x-r|
  double psnr = 0;           ///< 10 log10(peak^2 / mse), decibels; infinite where the images are equal
  double peak = 1;           ///< of psnr
  double max_error = 0;      ///< greatest |x-r| of a channel ...
  int max_x = 0, max_y = 0;  ///< ... and the first pixel that has it
  Vec3d bias;                ///< per channel, mean of x-r

  /// Names, lower case, as limits and JSON use them, with values; "bias" is the greatest |bias| of a channel.
  std::vector<std::pair<std::string, double>> named() const;
};

/// `peak`: the value that psnr is relative to, > 0. Throws InputError if the sizes differ or a pixel of
/// either is not finite, with the pixel.
ErrorMetrics measure_errors(const Image& image, const Image& reference, double peak);

/// How many percent of the pixels have a channel with |x-r| > bound.
double percent_beyond(const Image& image, const Image& reference, double bound);

/// The greatest component of an image, 1 where none is positive: the peak of psnr for radiance.
double greatest_component(const Image& image);

/// Structural similarity (Wang et al. 2004) of two images of shown values in [0,1] of one size: 11x11
/// Gaussian window of sigma 1.5, mean over the channels and the pixels whose window lies inside; where a side
/// is shorter than the window, windows are cut at the image's edge. At most 1, which only equal images reach.
double ssim(const Image& shown, const Image& reference);

/// Mean FLIP error in [0,1] of two sRGB-encoded images of one size, at 67.02 pixels per degree (Andersson et
/// al. 2020).
double flip(const Image& shown, const Image& reference);

/// Mean HDR FLIP error in [0,1] of two images of radiance of one size: per pixel the greatest FLIP error over
/// a range of exposures that the reference gives (Andersson et al. 2021).
double flip_hdr(const Image& image, const Image& reference);

/// A picture of the error, in values for display: per pixel sqrt(mean over channels of (x-r)^2 / (r^2 +
/// 0.01)), so that its mean square is relmse, on a logarithmic scale from 0.001 (black) to 1 (pale yellow),
/// always the same; with a labelled colour bar below.
Image heat_map(const Image& image, const Image& reference);

}  // namespace castray
