#include <algorithm>

#include "image/formats.h"

namespace castray {

namespace {

/// Moves the first `kept` of every `channels` values to the front.
template <class T>
void keep_channels(std::vector<T>& values, std::size_t channels, std::size_t kept) {
  auto to = values.begin();
  for (auto from = values.begin(); from != values.end(); from += static_cast<std::ptrdiff_t>(channels))
    to = std::copy_n(from, kept, to);
  values.erase(to, values.end());
  values.shrink_to_fit();
}

template <class T>
bool last_is(const std::vector<T>& values, std::size_t channels, T one) {
  for (std::size_t i = channels - 1; i < values.size(); i += channels)
    if (!(values[i] == one)) return false;
  return true;
}

}  // namespace

void drop_opaque_alpha(Raster& raster) {
  if (!raster.has_alpha()) return;
  const auto channels = static_cast<std::size_t>(raster.channels);
  if (!last_is<unsigned char>(raster.bytes, channels, 255) || !last_is(raster.floats, channels, 1.f)) return;
  keep_channels(raster.bytes, channels, channels - 1);
  keep_channels(raster.floats, channels, channels - 1);
  --raster.channels;
}

Image colours_of(const Raster& raster) {
  Image image(raster.width, raster.height);
  const auto channels = static_cast<std::size_t>(raster.channels);
  const std::size_t step = channels > 2 ? 1 : 0;
  std::size_t at = 0;
  for (Vec3f& pixel : image.pixels) {
    pixel = {raster.value(at), raster.value(at + step), raster.value(at + 2 * step)};
    at += channels;
  }
  return image;
}

}  // namespace castray
