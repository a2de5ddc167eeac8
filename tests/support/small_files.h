#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

// Image files made by hand, as their formats' texts describe them.

inline std::string big_endian(std::uint32_t value, int bytes = 4) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> 8 * i & 255);
  return text;
}

inline std::string little_endian(std::uint32_t value, int bytes = 2) {
  const std::string big = big_endian(value, bytes);
  return {big.rbegin(), big.rend()};
}

inline std::string png_chunk(const std::string& type_and_data) {
  const auto* bytes = reinterpret_cast<const Bytef*>(type_and_data.data());
  const auto sum = static_cast<std::uint32_t>(crc32_z(0, bytes, type_and_data.size()));
  return big_endian(static_cast<std::uint32_t>(type_and_data.size() - 4)) + type_and_data + big_endian(sum);
}

/// `rows`: the packed bytes of each row. `more`: chunks before the pixels.
inline std::string png_file(int width, int bits, int colour_type, const std::vector<std::string>& rows,
                            const std::string& more = "") {
  std::string raw;
  for (const std::string& row : rows) raw += '\0' + row;
  uLongf length = compressBound(raw.size());
  std::string packed(length, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &length, reinterpret_cast<const Bytef*>(raw.data()),
           raw.size());
  packed.resize(length);
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR" + big_endian(static_cast<std::uint32_t>(width)) +
                   big_endian(static_cast<std::uint32_t>(rows.size())) + static_cast<char>(bits) +
                   static_cast<char>(colour_type) + std::string(3, '\0')) +
         more + png_chunk("IDAT" + packed) + png_chunk("IEND");
}

/// A frame of a GIF file of four colours, `pixels` being their indices. Every pixel is preceded by a code
/// that clears the table, so that codes keep 3 bits.
inline std::string gif_frame(int width, int height, const std::string& pixels) {
  std::string data;
  unsigned bits = 0, count = 0;
  const auto put = [&](unsigned code) {
    bits |= code << count;
    for (count += 3; count >= 8; count -= 8, bits >>= 8) data += static_cast<char>(bits & 255);
  };
  for (const char pixel : pixels) put(4), put(static_cast<unsigned char>(pixel));
  put(5);
  put(0), put(0), put(0);  // the rest of the last byte
  const std::string size =
      little_endian(static_cast<std::uint32_t>(width)) + little_endian(static_cast<std::uint32_t>(height));
  return "," + std::string(4, '\0') + size + std::string("\0\2", 2) + static_cast<char>(data.size()) + data +
         '\0';
}

/// `palette`: four colours. `transparent`: the index of one that is, or -1.
inline std::string gif_file(int width, int height, const std::string& palette, int transparent,
                            const std::vector<std::string>& frames) {
  std::string bytes = "GIF89a" + little_endian(static_cast<std::uint32_t>(width)) +
                      little_endian(static_cast<std::uint32_t>(height)) + std::string("\x81\0\0", 3) +
                      palette;
  for (const std::string& frame : frames) {
    if (transparent >= 0) bytes += std::string("!\xf9\4\1\0\0", 6) + static_cast<char>(transparent) + '\0';
    bytes += gif_frame(width, height, frame);
  }
  return bytes + ";";
}

/// `planes`: the channels one after another, each value big-endian.
inline std::string psd_file(int width, int height, int channels, int bits, const std::string& planes) {
  return "8BPS" + big_endian(1, 2) + std::string(6, '\0') +
         big_endian(static_cast<std::uint32_t>(channels), 2) +
         big_endian(static_cast<std::uint32_t>(height)) + big_endian(static_cast<std::uint32_t>(width)) +
         big_endian(static_cast<std::uint32_t>(bits), 2) + big_endian(3, 2) + std::string(12, '\0') +
         std::string(2, '\0') + planes;
}
