#include <stb/stb_image_write.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "castray/error.h"
#include "image/formats.h"

namespace castray {

namespace {

// Read by hand: stb's reader takes missing bytes for zeros, and never ends where a run of length 0 repeats.

/// The bytes of a file, one after another. Throws InputError at the end.
class Bytes {
 public:
  Bytes(const std::string& name, std::string_view bytes) : name_(name), bytes_(bytes) {}

  unsigned char next() { return static_cast<unsigned char>(take(1)[0]); }
  std::string_view take(std::size_t count) {
    if (bytes_.size() < count) fail("is truncated");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::string_view line() {
    const std::string_view line = take(bytes_.find('\n') + 1);  // npos + 1: nothing
    if (line.empty()) fail("is truncated in its header");
    return line.substr(0, line.size() - 1);
  }
  std::size_t left() const { return bytes_.size(); }
  [[noreturn]] void fail(const std::string& what) const { throw InputError({name_}, what); }

 private:
  const std::string& name_;
  std::string_view bytes_;
};

using Rgbe = std::array<unsigned char, 4>;

Vec3f light_of(const Rgbe& v) {
  if (v[3] == 0) return {};
  const float unit = std::ldexp(1.f, v[3] - (128 + 8));
  return Vec3f(v[0], v[1], v[2]) * unit;
}

/// One scanline: planes of runs (Ward, Radiance file formats), or flat pixels.
void read_scanline(Bytes& in, std::vector<Rgbe>& row) {
  const auto pixel = [&] { return Rgbe{in.next(), in.next(), in.next(), in.next()}; };
  const Rgbe start = pixel();
  const std::size_t width = row.size();
  const bool in_planes = width >= 8 && width < 32768 && start[0] == 2 && start[1] == 2 && start[2] < 128;
  if (!in_planes) {
    row[0] = start;
    for (std::size_t x = 1; x < width; ++x) row[x] = pixel();
    return;
  }
  if (static_cast<std::size_t>(start[2] << 8 | start[3]) != width)
    in.fail("is corrupt: a line of another width");
  for (std::size_t plane = 0; plane < 4; ++plane)
    for (std::size_t x = 0; x < width;) {
      const unsigned char code = in.next();
      const std::size_t count = code > 128 ? code - 128u : code;
      if (count == 0 || count > width - x) in.fail("is corrupt: a run of a wrong length");
      unsigned char value = 0;
      for (std::size_t i = 0; i < count; ++i) {
        if (i == 0 || code <= 128) value = in.next();
        row[x++][plane] = value;
      }
    }
}

/// RGBE has no NaN, no infinity and nothing negative.
float representable(float v) { return v > 0 ? std::min(v, 0x1p126f) : 0.f; }

}  // namespace

ImageFile read_hdr(const std::string& name, std::string_view bytes) {
  Bytes in(name, bytes);
  if (!bytes.starts_with("#?")) in.fail("is not a Radiance HDR file");
  for (std::string_view line = in.line(); !line.empty(); line = in.line())
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      in.fail("holds " + std::string(line.substr(7, 40)) + "; only 32-bit_rle_rgbe is read");
  const std::string size(in.line());
  int width = 0, height = 0, length = 0;
  if (std::sscanf(size.c_str(), "-Y %d +X %d%n", &height, &width, &length) != 2 ||
      size.size() != static_cast<std::size_t>(length))
    in.fail("has the size line '" + size.substr(0, 40) + "'; only '-Y HEIGHT +X WIDTH' is read");
  check_image_size(name, width, height, in.left(), 32);  // runs of 127 in each of four planes
  Image image(width, height);
  std::vector<Rgbe> row(static_cast<std::size_t>(width));
  auto pixel = image.pixels.begin();
  for (int y = 0; y < height; ++y) {
    read_scanline(in, row);
    pixel = std::transform(row.begin(), row.end(), pixel, light_of);
  }
  return {std::move(image), false, {}};
}

void write_hdr(std::ostream& out, const Image& image) {
  std::vector<float> data;
  data.reserve(3 * image.pixels.size());
  for (const Vec3f& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) data.push_back(representable(pixel[c]));
  const auto write = [](void* stream, void* bytes, int size) {
    static_cast<std::ostream*>(stream)->write(static_cast<const char*>(bytes), size);
  };
  stbi_write_hdr_to_func(write, &out, image.width, image.height, 3, data.data());
}

}  // namespace castray
