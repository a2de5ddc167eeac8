#include <stb/stb_image_write.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "castray/error.h"
#include "image/formats.h"
#include "image/row_writer.h"

namespace castray {

namespace {

// Read by hand: stb's reader takes missing bytes for zeros, and never ends where a run of length 0 repeats.

using Rgbe = std::array<unsigned char, 4>;

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
  Rgbe pixel() { return {next(), next(), next(), next()}; }
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

Vec3f light_of(const Rgbe& v) {
  if (v[3] == 0) return {};
  const float unit = std::ldexp(1.f, v[3] - (128 + 8));
  return Vec3f(v[0], v[1], v[2]) * unit;
}

bool in_planes(const Rgbe& start, std::size_t width) {
  return width >= 8 && width < 32768 && start[0] == 2 && start[1] == 2 && start[2] < 128;
}

/// Flat pixels, among which (1, 1, 1, n) repeats the one before n times; more of them count higher digits.
void read_flat_line(Bytes& in, Rgbe pixel, std::vector<Rgbe>& row) {
  unsigned shift = 0;
  for (std::size_t x = 0;;) {
    const bool repeats = pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1;
    const std::size_t count = repeats ? std::size_t{pixel[3]} << shift : 1;
    if ((repeats && x == 0) || count > row.size() - x || shift > 24)
      in.fail("is corrupt: a run of a wrong length");
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, repeats ? row[x - 1] : pixel);
    x += count;
    shift = repeats ? shift + 8 : 0;
    if (x == row.size()) return;
    pixel = in.pixel();
  }
}

/// A plane of runs for each byte of a pixel.
void read_planes(Bytes& in, std::vector<Rgbe>& row) {
  const std::size_t width = row.size();
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

/// One scanline (Ward, Radiance file formats).
void read_scanline(Bytes& in, std::vector<Rgbe>& row) {
  const Rgbe start = in.pixel();
  if (!in_planes(start, row.size())) return read_flat_line(in, start, row);
  if (static_cast<std::size_t>(start[2] << 8 | start[3]) != row.size())
    in.fail("is corrupt: a line of another width");
  read_planes(in, row);
}

/// What the header's lines say of the pixels.
struct HeaderLines {
  Vec3d divisor{1, 1, 1};  ///< the product of all EXPOSURE and COLORCORR

  void read(Bytes& in, std::string_view line) {
    const auto value_of = [&](std::string_view key) { return std::string(line.substr(key.size())); };
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      in.fail("holds " + std::string(line.substr(7, 40)) + "; only 32-bit_rle_rgbe is read");
    double r = 1, g = 1, b = 1;
    if (line.starts_with("EXPOSURE=")) {
      if (std::sscanf(value_of("EXPOSURE=").c_str(), "%lf", &r) != 1) r = 0;
      g = b = r;
    } else if (line.starts_with("COLORCORR=")) {
      if (std::sscanf(value_of("COLORCORR=").c_str(), "%lf %lf %lf", &r, &g, &b) != 3) r = 0;
    }
    divisor = {divisor.x * r, divisor.y * g, divisor.z * b};
    for (int c = 0; c < 3; ++c)
      if (!(divisor[c] > 0x1p-100 && divisor[c] < 0x1p100))
        in.fail("has a header line that cannot be: '" + std::string(line.substr(0, 40)) + "'");
  }
};

/// One of "-Y 480 +X 640": an axis that lines, or the pixels of a line, run along.
struct Axis {
  bool is_x = false,
       is_reversed = false;  ///< reversed: towards the left or the top, against an image's order
  int length = 0;

  /// The column or row of place i.
  int at(int i) const { return is_reversed ? length - 1 - i : i; }
};

/// Takes an axis off the front of `text`; false where there is none.
bool take_axis(std::string_view& text, Axis& axis) {
  constexpr std::size_t sign_and_name = 3;
  if (text.size() <= sign_and_name || text[2] != ' ' || (text[0] != '-' && text[0] != '+') ||
      (text[1] != 'X' && text[1] != 'Y'))
    return false;
  axis.is_x = text[1] == 'X';
  axis.is_reversed = (text[0] == '-') == axis.is_x;  // Y points upwards
  text.remove_prefix(sign_and_name);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), axis.length);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return error == std::errc() && axis.length > 0;
}

struct Axes {
  Axis lines, pixels;
};

Axes read_size_line(Bytes& in) {
  const std::string_view line = in.line();
  std::string_view text = line;
  Axes axes;
  bool good = take_axis(text, axes.lines) && text.starts_with(' ');
  if (good) text.remove_prefix(1);
  good = good && take_axis(text, axes.pixels) && text.empty() && axes.lines.is_x != axes.pixels.is_x;
  if (!good)
    in.fail("has the size line '" + std::string(line.substr(0, 40)) + "'; expected as in '-Y 480 +X 640'");
  return axes;
}

/// The nearest colour that a file can hold. RGBE has no NaN, no infinity and nothing negative; its three
/// values share the exponent of the greatest.
Vec3f nearest_rgbe(const Vec3f& colour) {
  Vec3f v;
  for (int c = 0; c < 3; ++c) v[c] = colour[c] > 0 ? std::min(colour[c], 0x1p126f) : 0.f;
  int exponent = 0;
  if (std::frexp(max_component(v), &exponent) >= 255.5f / 256) ++exponent;  // it would round to 256
  const float unit = std::ldexp(1.f, std::max(exponent, -110) - 8);
  for (int c = 0; c < 3; ++c) v[c] = std::nearbyint(v[c] / unit) * unit;
  return v;
}

}  // namespace

Decoded read_hdr(const std::string& name, std::string_view bytes) {
  Bytes in(name, bytes);
  if (!bytes.starts_with("#?")) in.fail("is not a Radiance HDR file");
  HeaderLines header;
  for (std::string_view line = in.line(); !line.empty(); line = in.line()) header.read(in, line);
  const Axes axes = read_size_line(in);
  const Axis &x_axis = axes.lines.is_x ? axes.lines : axes.pixels,
             &y_axis = axes.lines.is_x ? axes.pixels : axes.lines;
  check_image_size(name, x_axis.length, y_axis.length, in.left(), 32);  // runs of 127 in each of four planes
  Raster raster{x_axis.length, y_axis.length, 3, false, {}, {}};
  raster.floats.resize(3 * static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height));
  std::vector<Rgbe> row(static_cast<std::size_t>(axes.pixels.length));
  for (int line = 0; line < axes.lines.length; ++line) {
    read_scanline(in, row);
    for (int i = 0; i < axes.pixels.length; ++i) {
      const int x = x_axis.at(axes.lines.is_x ? line : i), y = y_axis.at(axes.lines.is_x ? i : line);
      float* to = &raster.floats[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(raster.width) +
                                      static_cast<std::size_t>(x))];
      const Vec3f light = light_of(row[static_cast<std::size_t>(i)]);
      for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(light[c] / header.divisor[c]);
    }
  }
  return {std::move(raster)};
}

namespace {

/// stb writes whole files: of each piece its header is left out, but for the first, which tells all rows.
class HdrWriter final : public RowWriter {
 public:
  HdrWriter(std::ostream& out, const WrittenImage& image) : out_(out), height_(image.height) {}

  void add(const Image& rows) override {
    const std::string bytes = file_of(rows);
    const std::size_t size_line = bytes.find("\n-Y ") + 1, pixels = bytes.find('\n', size_line) + 1;
    if (first_) out_ << bytes.substr(0, size_line) << "-Y " << height_ << " +X " << rows.width << '\n';
    first_ = false;
    out_.write(bytes.data() + pixels, static_cast<std::streamsize>(bytes.size() - pixels));
  }

 private:
  static std::string file_of(const Image& rows) {
    std::vector<float> data;  // stb truncates, so it gets what it can store exactly
    data.reserve(3 * rows.pixels.size());
    for (const Vec3f& pixel : rows.pixels) {
      const Vec3f nearest = nearest_rgbe(pixel);
      data.insert(data.end(), {nearest.x, nearest.y, nearest.z});
    }
    std::string bytes;
    const auto append = [](void* to, void* from, int size) {
      static_cast<std::string*>(to)->append(static_cast<const char*>(from), static_cast<std::size_t>(size));
    };
    stbi_write_hdr_to_func(append, &bytes, rows.width, rows.height, 3, data.data());
    return bytes;
  }

  std::ostream& out_;
  int height_;
  bool first_ = true;
};

}  // namespace

std::unique_ptr<RowWriter> write_hdr(std::ostream& out, const WrittenImage& image) {
  return std::make_unique<HdrWriter>(out, image);
}

}  // namespace castray
