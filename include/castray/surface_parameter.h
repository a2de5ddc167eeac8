#pragma once

#include <stdint.h>

// What hosts and kernels both name of a surface; plain enumerations, so that kernels may include them.

namespace castray {

/// How a surface reflects; the definitions are in docs/materials.md.
enum class MaterialType : uint8_t { diffuse, microfacet, conductor, dielectric, principled };

/// What of a surface an image can change from point to point.
enum class SurfaceParameter : uint8_t {
  kd,
  ks,
  reflectance,
  transmittance,
  ke,
  alpha,      ///< GGX width
  roughness,  ///< its square root
  metallic,
  sheen,
  clearcoat,
  clearcoat_roughness,
  coverage,
  normal,  ///< the shading normal in the frame of the texture coordinates, (r,g,b) = (1 + n) / 2
  bump,    ///< the shading normal by a height
  anisotropy,
  anisotropy_rotation,
  anisotropy_direction,  ///< where lobes are wide, (r,g) = (1 + d) / 2 in the frame of the texture
                         ///< coordinates
};
inline constexpr int surface_parameters = 17;

/// What a surface parameter reads of an image: its colour (numbers take the luminance), or one channel.
enum class Channel : uint8_t { color, red, green, blue, alpha, luminance };

}  // namespace castray
