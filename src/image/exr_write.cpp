#include <half.h>
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <ostream>

#include "image/exr_channels.h"
#include "image/row_writer.h"

namespace castray {

namespace {

class StreamOut : public Imf::OStream {
 public:
  explicit StreamOut(std::ostream& out) : OStream("image"), out_(out) {}
  void write(const char* from, int count) override { out_.write(from, count); }
  std::uint64_t tellp() override {
    return static_cast<std::uint64_t>(std::max<std::streamoff>(out_.tellp(), 0));
  }
  void seekp(std::uint64_t position) override { out_.seekp(static_cast<std::streamoff>(position)); }

 private:
  std::ostream& out_;
};

const float* floats_of(const Image& image) { return reinterpret_cast<const float*>(image.pixels.data()); }

/// Finite values stay finite.
half half_of(float v) { return half(std::isfinite(v) ? std::clamp<float>(v, -HALF_MAX, HALF_MAX) : v); }

std::vector<half> halves_of(const Image& image) {
  std::vector<half> halves;
  halves.reserve(3 * image.pixels.size());
  for (const Vec3f& v : image.pixels)
    for (int c = 0; c < 3; ++c) halves.push_back(half_of(v[c]));
  return halves;
}

/// Rows y0 <= y < y1 of a channel of this width.
std::vector<half> halves_of(const ImageChannel& channel, int width, int y0, int y1) {
  const auto row = [&](int y) { return channel.values.begin() + std::ptrdiff_t{y} * width; };
  std::vector<half> halves;
  std::transform(row(y0), row(y1), std::back_inserter(halves), half_of);
  return halves;
}

/// Adds three channels, interleaved. (A frame buffer takes writable memory, though writing only reads it.)
template <class T>
void add_to(Imf::FrameBuffer& frame, const T* values, int width, const std::array<const char*, 3>& names,
            const Imath::Box2i& window) {
  for (std::size_t c = 0; c < 3; ++c) frame.insert(names[c], exr_slice(values + c, 3, width, window));
}

/// Names that the format gives a meaning of its own are left out.
void add_metadata(Imf::Header& header, const Metadata& metadata) {
  constexpr std::string_view reserved[] = {
      "type", "name", "view", "version", "chunkCount", "tiles", "maxSamplesPerPixel"};
  for (const auto& [key, value] : metadata)
    if (header.find(key) == header.end() &&
        std::find(std::begin(reserved), std::end(reserved), key) == std::end(reserved))
      header.insert(key, Imf::StringAttribute(value));
}

class ExrWriter final : public RowWriter {
 public:
  ExrWriter(std::ostream& out, const WrittenImage& image)
      : noise_(image.noise),
        passes_(image.passes),
        bits16_(image.display.bits16),
        stream_(out),
        file_(stream_, header_of(image), 0) {}

  void add(const Image& rows) override {
    const Imath::Box2i window({0, y_}, {rows.width - 1, y_ + rows.height - 1});
    Imf::FrameBuffer frame;
    const std::vector<half> halves = bits16_ ? halves_of(rows) : std::vector<half>();
    if (bits16_)
      add_to(frame, halves.data(), rows.width, exr_rgb, window);
    else
      add_to(frame, floats_of(rows), rows.width, exr_rgb, window);
    if (noise_)
      add_to(frame, reinterpret_cast<const float*>(&noise_->variance.at(0, y_)), rows.width, exr_variances,
             window);
    std::vector<std::vector<half>> halves_of_passes;
    for (const ImageChannel& channel : passes_.channels) {
      if (is_half(channel, bits16_)) {
        halves_of_passes.push_back(halves_of(channel, rows.width, y_, y_ + rows.height));
        frame.insert(channel.name, exr_slice(halves_of_passes.back().data(), 1, rows.width, window));
      } else {
        const float* first = channel.values.data() + std::ptrdiff_t{y_} * rows.width;
        frame.insert(channel.name, exr_slice(first, 1, rows.width, window));
      }
    }
    file_.setFrameBuffer(frame);
    file_.writePixels(rows.height);
    y_ += rows.height;
  }

 private:
  static Imf::Header header_of(const WrittenImage& image) {
    Imf::Header header(image.width, image.height);
    const Imf::PixelType rgb_type = image.display.bits16 ? Imf::HALF : Imf::FLOAT;
    for (const char* name : exr_rgb) header.channels().insert(name, Imf::Channel(rgb_type));
    if (const auto& noise = image.noise) {
      for (const char* name : exr_variances) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      header.insert(exr_freedom, Imf::FloatAttribute(static_cast<float>(noise->freedom)));
    }
    for (const ImageChannel& channel : image.passes.channels)
      header.channels().insert(channel.name,
                               Imf::Channel(is_half(channel, image.display.bits16) ? Imf::HALF : Imf::FLOAT));
    add_metadata(header, image.metadata);
    add_metadata(header, image.passes.metadata);
    return header;
  }

  static bool is_half(const ImageChannel& channel, bool bits16) { return bits16 && channel.may_be_half; }

  const std::optional<Noise>& noise_;
  const Passes& passes_;
  bool bits16_;
  StreamOut stream_;
  Imf::OutputFile file_;
  int y_ = 0;
};

}  // namespace

std::unique_ptr<RowWriter> write_exr(std::ostream& out, const WrittenImage& image) {
  return std::make_unique<ExrWriter>(out, image);
}

}  // namespace castray
