#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ostream>

#include "castray/error.h"
#include "image/formats.h"
#include "image/row_writer.h"

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
  /// Of so many bytes: behind a whole CR LF where the file has one byte more than they need.
  std::size_t end_before(std::size_t count) const {
    return end() + (rest() == count + 1 && bytes_.substr(at_, 2) == "\r\n");
  }

 private:
  const std::string& name_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

constexpr int max_side = 1 << 24;

Raster sized_raster(const std::string& name, Header& header, int channels) {
  Raster raster;
  raster.width = header.number("width", 1, max_side);
  raster.height = header.number("height", 1, max_side);
  raster.channels = channels;
  check_image_size(name, raster.width, raster.height, header.rest(), 1);
  return raster;
}

std::size_t count_values(const Raster& raster) {
  return static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height) *
         static_cast<std::size_t>(raster.channels);
}

}  // namespace

Decoded read_netpbm(const std::string& name, std::string_view bytes) {
  Header header(name, bytes);
  const std::string magic = header.word();
  const bool text = magic == "P2" || magic == "P3", grey = magic == "P2" || magic == "P5";
  if (!text && magic != "P5" && magic != "P6")
    throw InputError({name}, "is not a PPM or PGM file (P2, P3, P5 or P6)");
  Raster raster = sized_raster(name, header, grey ? 1 : 3);
  raster.encoded = true;
  const int max_value = header.number("greatest value", 1, 65535);
  const std::size_t count = count_values(raster);
  const std::size_t sample_bytes = max_value > 255 ? 2 : 1;
  if (!text && header.rest() < sample_bytes * count) throw InputError({name}, "is truncated");
  const auto* at =
      reinterpret_cast<const unsigned char*>(bytes.data()) + header.end_before(sample_bytes * count);
  if (!text && max_value == 255) {
    raster.bytes.assign(at, at + count);
    return {std::move(raster)};
  }
  const auto next = [&]() -> int {
    if (text) return header.number("sample", 0, max_value);
    at += sample_bytes;
    return sample_bytes == 1 ? at[-1] : at[-2] << 8 | at[-1];
  };
  raster.floats.resize(count);
  for (float& value : raster.floats)
    value = std::min(static_cast<float>(next()) / static_cast<float>(max_value), 1.f);
  return {std::move(raster)};
}

Decoded read_pfm(const std::string& name, std::string_view bytes) {
  Header header(name, bytes);
  const std::string magic = header.word();
  if (magic != "PF" && magic != "Pf") throw InputError({name}, "is not a PFM file (PF or Pf)");
  Raster raster = sized_raster(name, header, magic == "PF" ? 3 : 1);
  const double scale = header.number("scale", -1e30, 1e30);
  if (scale == 0) throw InputError({name}, "has scale 0, which gives no byte order");
  raster.floats.resize(count_values(raster));
  const std::size_t count = sizeof(float) * raster.floats.size();
  if (header.rest() < count) throw InputError({name}, "is truncated");
  const char* at = bytes.data() + header.end_before(count);
  const std::size_t row = raster.floats.size() / static_cast<std::size_t>(raster.height);
  for (std::size_t start = raster.floats.size(); start > 0; start -= row)  // bottom row first
    for (std::size_t i = start - row; i < start; ++i, at += sizeof(float)) {
      std::uint32_t bits;
      std::memcpy(&bits, at, sizeof bits);
      raster.floats[i] = std::bit_cast<float>(scale < 0 ? bits : __builtin_bswap32(bits));
    }
  return {std::move(raster)};
}

namespace {

class PpmWriter final : public RowWriter {
 public:
  PpmWriter(std::ostream& out, const WrittenImage& image) : out_(out), display_(image.display) {
    out << "P6\n" << image.width << ' ' << image.height << (display_.bits16 ? "\n65535\n" : "\n255\n");
  }
  void add(const Image& rows) override {
    for (int y = 0; y < rows.height; ++y) {
      const std::vector<unsigned char> bytes = quantised(row_of(rows, y), display_);
      out_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
  }

 private:
  std::ostream& out_;
  const Display& display_;
};

/// The format has the bottom row first.
class PfmWriter final : public RowWriter {
 public:
  PfmWriter(std::ostream& out, const WrittenImage& image) : out_(out), rows_left_(image.height) {
    out << "PF\n" << image.width << ' ' << image.height << "\n-1.0\n";
    begin_ = static_cast<std::streamoff>(out.tellp());
  }
  void add(const Image& rows) override {
    static_assert(sizeof(Vec3f) == 12);
    const std::streamsize row_bytes = 12L * rows.width;
    rows_left_ -= rows.height;
    if (moved_ || rows_left_ > 0) out_.seekp(begin_ + rows_left_ * row_bytes);
    moved_ = true;
    for (int y = rows.height - 1; y >= 0; --y)
      out_.write(reinterpret_cast<const char*>(&rows.at(0, y)), row_bytes);
  }

 private:
  std::ostream& out_;
  std::streamoff begin_ = 0;  ///< of the pixels
  int rows_left_;
  bool moved_ = false;
};

}  // namespace

std::unique_ptr<RowWriter> write_ppm(std::ostream& out, const WrittenImage& image) {
  return std::make_unique<PpmWriter>(out, image);
}

std::unique_ptr<RowWriter> write_pfm(std::ostream& out, const WrittenImage& image) {
  return std::make_unique<PfmWriter>(out, image);
}

}  // namespace castray
