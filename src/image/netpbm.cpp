#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ostream>

#include "castray/error.h"
#include "image/formats.h"

static_assert(std::endian::native == std::endian::little,
              "PFM and film files are written as memory holds them");

namespace castray {

namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Words of a header that is separated by white space, with comments from # to the end of the line.
class Header {
 public:
  Header(const std::string& name, std::string_view bytes) : name_(name), bytes_(bytes) {}

  std::string word() {
    while (at_ < bytes_.size() && (is_space(bytes_[at_]) || bytes_[at_] == '#')) {
      if (bytes_[at_] == '#')
        at_ = std::min(bytes_.find('\n', at_), bytes_.size());
      else
        ++at_;
    }
    const std::size_t first = at_;
    while (at_ < bytes_.size() && !is_space(bytes_[at_])) ++at_;
    return std::string(bytes_.substr(first, at_ - first));
  }

  template <class T>
  T number(const char* what, T low, T high) {
    const std::string text = word();
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() ||
        !(value >= low && value <= high))
      throw InputError({name_}, "bad " + std::string(what) + " '" + text.substr(0, 40) + "' in the file");
    return value;
  }

  /// Where the pixels start: behind the single white space that ends the header.
  std::size_t end() const { return std::min(at_ + 1, bytes_.size()); }
  std::size_t rest() const { return bytes_.size() - end(); }

 private:
  const std::string& name_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

constexpr int max_side = 1 << 24;

Image sized_image(const std::string& name, Header& header) {
  const int width = header.number("width", 1, max_side);
  const int height = header.number("height", 1, max_side);
  check_image_size(name, width, height, header.rest(), 1);
  return Image(width, height);
}

std::size_t row_start(const Image& image, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width);
}

}  // namespace

ImageFile read_ppm(const std::string& name, std::string_view bytes) {
  Header header(name, bytes);
  const std::string magic = header.word();
  if (magic != "P6" && magic != "P3") throw InputError({name}, "is not a colour PPM file (P6 or P3)");
  Image image = sized_image(name, header);
  const int max_value = header.number("greatest value", 1, 65535);
  const float scale = static_cast<float>(max_value);
  const auto fill = [&](auto next) {
    for (Vec3f& pixel : image.pixels)
      for (int c = 0; c < 3; ++c) pixel[c] = std::min(static_cast<float>(next()) / scale, 1.f);
  };
  if (magic == "P3") {
    fill([&] { return header.number("sample", 0, max_value); });
  } else {
    const std::size_t sample_bytes = max_value > 255 ? 2 : 1;
    if (header.rest() < 3 * sample_bytes * image.pixels.size()) throw InputError({name}, "is truncated");
    const auto* at = reinterpret_cast<const unsigned char*>(bytes.data()) + header.end();
    if (sample_bytes == 1)
      fill([&] { return *at++; });
    else
      fill([&] { return at += 2, at[-2] << 8 | at[-1]; });
  }
  return {std::move(image), true, {}};
}

ImageFile read_pfm(const std::string& name, std::string_view bytes) {
  Header header(name, bytes);
  const std::string magic = header.word();
  if (magic != "PF" && magic != "Pf") throw InputError({name}, "is not a PFM file (PF or Pf)");
  Image image = sized_image(name, header);
  const double scale = header.number("scale", -1e30, 1e30);
  if (scale == 0) throw InputError({name}, "has scale 0, which gives no byte order");
  const std::size_t channels = magic == "PF" ? 3 : 1;
  if (header.rest() < 4 * channels * image.pixels.size()) throw InputError({name}, "is truncated");
  const char* at = bytes.data() + header.end();
  const auto next = [&] {
    std::uint32_t bits;
    std::memcpy(&bits, at, 4);
    at += 4;
    return std::bit_cast<float>(scale < 0 ? bits : __builtin_bswap32(bits));
  };
  for (int y = image.height - 1; y >= 0; --y)
    for (int x = 0; x < image.width; ++x) {
      Vec3f& pixel = image.at(x, y);
      pixel.x = next();
      if (channels == 1)
        pixel = Vec3f(pixel.x);
      else
        pixel.y = next(), pixel.z = next();
    }
  return {std::move(image), false, {}};
}

void write_ppm(std::ostream& out, const QuantisedImage& image) {
  out << "P6\n" << image.width << ' ' << image.height << (image.bits == 16 ? "\n65535\n" : "\n255\n");
  out.write(reinterpret_cast<const char*>(image.bytes.data()),
            static_cast<std::streamsize>(image.bytes.size()));
}

void write_pfm(std::ostream& out, const Image& image) {
  static_assert(sizeof(Vec3f) == 12);
  out << "PF\n" << image.width << ' ' << image.height << "\n-1.0\n";
  for (int y = image.height - 1; y >= 0; --y)
    out.write(reinterpret_cast<const char*>(&image.pixels[row_start(image, y)]), 12L * image.width);
}

}  // namespace castray
