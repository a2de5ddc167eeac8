#pragma once

#include <string_view>
#include <vector>

#include "castray/vec.h"

namespace castray {

/// A metal's reflectance straight on, ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2) of measured n and k, seen by the
/// observer of CIE 1931 under D65 and taken to linear sRGB, whose range gold leaves by 0.04 in red: 1 here.
/// And an index for each channel, which tells how it goes on to grazing angles: `eta` is n near 650, 550 and
/// 450 nm, `k` is such that the reflectance straight on is this (or 0.999, if that is less).
struct NamedMetal {
  std::string_view name;
  Vec3d reflectance;
  Vec3d eta, k;
};

/// The reflectance straight on, in each channel, of a metal of complex index eta + i k (of air: 1).
Vec3d reflectance_of_index(const Vec3d& eta, const Vec3d& k);

/// Silver, gold, copper: Johnson and Christy 1972, Physical Review B 6. Iron, chromium: Johnson and Christy
/// 1974, Physical Review B 9. Aluminium: Cheng and others 2016, ACS Nano 10.
const std::vector<NamedMetal>& named_metals();

}  // namespace castray
