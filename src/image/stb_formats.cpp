#include <stb/stb_image.h>
#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

#include "castray/error.h"
#include "image/formats.h"

namespace castray {

namespace {

/// Feeds stb_image and notes whether it asked for more than there is: it takes missing bytes for zeros.
struct Feed {
  std::string_view bytes;
  std::size_t at = 0;
  bool truncated = false;

  int read(char* to, int asked) {
    constexpr int buffer_size = 128;  // stb fills its buffer so: to get fewer is no harm, to get none is
    const auto wanted = static_cast<std::size_t>(asked);
    const std::size_t count = std::min(wanted, bytes.size() - at);
    std::memcpy(to, bytes.data() + at, count);
    at += count;
    if (count == wanted || (asked == buffer_size && count > 0)) return static_cast<int>(count);
    truncated = true;
    std::memset(to + count, 0, wanted - count);  // stb would use what the memory held
    return asked == buffer_size ? 0 : asked;
  }
  void skip(int count) {
    const auto n = static_cast<std::size_t>(std::max(count, 0));
    truncated |= n > bytes.size() - at;
    at += std::min(n, bytes.size() - at);
  }
};

constexpr stbi_io_callbacks feed_stb{
    [](void* feed, char* to, int asked) { return static_cast<Feed*>(feed)->read(to, asked); },
    [](void* feed, int count) { static_cast<Feed*>(feed)->skip(count); },
    [](void* feed) {
      return static_cast<int>(static_cast<Feed*>(feed)->at == static_cast<Feed*>(feed)->bytes.size());
    }};

template <class T>
std::vector<T> taken(T* pixels, std::size_t count) {
  if (!pixels) return {};
  const std::unique_ptr<T, decltype(&stbi_image_free)> owner(pixels, stbi_image_free);
  return {pixels, pixels + count};
}

/// `pixels_per_byte`: the most that the format packs. `deep`: the file holds 16 bits a value.
Decoded read(const std::string& name, std::string_view bytes, const char* format, double pixels_per_byte,
             bool deep = false) {
  const auto fail = [&] {
    throw InputError({name},
                     std::string("is a corrupt or unusual ") + format + " file: " + stbi_failure_reason());
  };
  if (bytes.size() > std::size_t{std::numeric_limits<int>::max()})
    throw InputError({name}, "is longer than 2 GiB");
  const auto* first = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int length = static_cast<int>(bytes.size());
  Raster raster;
  raster.encoded = true;
  if (!stbi_info_from_memory(first, length, &raster.width, &raster.height, &raster.channels)) fail();
  check_image_size(name, raster.width, raster.height, bytes.size(), pixels_per_byte);
  const std::size_t count = static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height) *
                            static_cast<std::size_t>(raster.channels);
  Feed feed{bytes};
  int width = 0, height = 0, own_channels = 0;
  if (deep)
    for (const stbi_us value :
         taken(stbi_load_16_from_callbacks(&feed_stb, &feed, &width, &height, &own_channels, raster.channels),
               count))
      raster.floats.push_back(static_cast<float>(value) / 65535.f);
  else
    raster.bytes = taken(
        stbi_load_from_callbacks(&feed_stb, &feed, &width, &height, &own_channels, raster.channels), count);
  if (feed.truncated) throw InputError({name}, "is truncated");
  if (raster.bytes.empty() && raster.floats.empty()) fail();
  drop_opaque_alpha(raster);
  return {std::move(raster)};
}

}  // namespace

// The densest packing: a whole line of 8x8 blocks in a few bits; codes of 12 bits for 4096 pixels; runs of
// 128.
Decoded read_jpeg(const std::string& name, std::string_view bytes) { return read(name, bytes, "JPEG", 2000); }
Decoded read_gif(const std::string& name, std::string_view bytes) { return read(name, bytes, "GIF", 3000); }
Decoded read_tga(const std::string& name, std::string_view bytes) { return read(name, bytes, "TGA", 64); }
Decoded read_bmp(const std::string& name, std::string_view bytes) { return read(name, bytes, "BMP", 8); }
Decoded read_psd(const std::string& name, std::string_view bytes) {
  // stbi_is_16_bit_from_memory misses such files
  constexpr std::size_t depth_at = 22;
  return read(name, bytes, "PSD", 64,
              bytes.substr(std::min(depth_at, bytes.size())).starts_with(std::string_view("\0\x10", 2)));
}

}  // namespace castray
