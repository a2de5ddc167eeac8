#pragma once

#include <optional>
#include <string>

namespace castray {

/// Where the sun stands, in degrees.
struct SunPosition {
  double elevation;  ///< above the horizon, without refraction
  double azimuth;    ///< from north towards east, in [0,360)
};

/// At `days` since noon UTC of 1 January 2000, seen from latitude (north) and longitude (east), in degrees.
/// By the Astronomical Almanac's low-precision formulas, as Michalsky 1988 (Solar Energy 40) has them: within
/// 0.01 degrees from 1950 to 2050; parallax, up to 0.0025 degrees, is left out.
SunPosition sun_position(double days, double latitude, double longitude);

/// By how many degrees air lifts the sun, near sea level (Saemundsson 1986, Sky and Telescope 72); from -1
/// degree of elevation up.
double refraction(double elevation);

/// Days since noon UTC of 1 January 2000 of a time as "2003-10-17T19:30:30Z" or "2003-10-17T12:30:30-07:00"
/// (ISO 8601; seconds may be left out). None where it is no such time, or not from 1900 to 2100.
std::optional<double> days_of(const std::string& time);

}  // namespace castray
