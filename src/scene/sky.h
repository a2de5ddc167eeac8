#pragma once

#include "castray/image.h"

namespace castray {

/// A clear sky with the sun in it.
struct Sky {
  double turbidity = 3;         ///< of the air, 1.7 (very clear) to 10 (hazy)
  double sun_elevation = 45;    ///< degrees above the horizon, 0 to 90
  double sun_azimuth = 0;       ///< degrees from -z towards +x
  bool sun = true;              ///< its disc is there; else only what it does to the sky
  Vec3d ground{0.2, 0.2, 0.2};  ///< albedo of the ground below the horizon
};

inline constexpr double least_turbidity = 1.7, greatest_turbidity = 10;

/// The sky in latitude and longitude, as EnvironmentImage has it, `height` rows of twice as many texels; in
/// 1000 cd/m^2. Preetham, Shirley and Smits 1999: luminance and chromaticity by appendix A.2. The sun's
/// disc has the illuminance outside the air, 127.5 klx, times the transmittances of Rayleigh scattering and
/// aerosol of appendix A.1 at one wavelength for each of red, green and blue; ozone, mixed gases and water
/// vapour are left out. Texels that the disc covers in part have that part of it. The ground reflects both by
/// Lambert's law.
Image sky_image(const Sky& sky, int height);

/// From `ground` below the horizon; above it `horizon` turns into `zenith` with the sine of the elevation.
Image gradient_image(const Vec3d& zenith, const Vec3d& horizon, const Vec3d& ground, int height);

}  // namespace castray
