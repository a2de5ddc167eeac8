#pragma once

#include <half.h>
#include <ImathBox.h>
#include <ImfFrameBuffer.h>
#include <array>
#include <type_traits>

namespace castray {

inline constexpr std::array<const char*, 3> exr_rgb = {"R", "G", "B"};
inline constexpr std::array<const char*, 3> exr_variances = {"variance.R", "variance.G", "variance.B"};
inline constexpr const char* exr_freedom = "varianceFreedom";  ///< float attribute: Noise::freedom

/// One of `channels` interleaved channels, the first value that of the upper left pixel of `window`, in an
/// image of this width.
template <class T>
Imf::Slice exr_slice(const T* values, std::size_t channels, int width, const Imath::Box2i& window) {
  constexpr Imf::PixelType type = std::is_same_v<T, half> ? Imf::HALF : Imf::FLOAT;
  return Imf::Slice::Make(type, values, window, channels * sizeof(T),
                          channels * sizeof(T) * static_cast<std::size_t>(width));
}

}  // namespace castray
