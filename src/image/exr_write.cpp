#include <half.h>
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <algorithm>
#include <cmath>
#include <ostream>

#include "image/exr_channels.h"
#include "image/formats.h"

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
std::vector<half> halves_of(const Image& image) {
  std::vector<half> halves;
  halves.reserve(3 * image.pixels.size());
  for (const Vec3f& v : image.pixels)
    for (int c = 0; c < 3; ++c)
      halves.emplace_back(std::isfinite(v[c]) ? std::clamp<float>(v[c], -HALF_MAX, HALF_MAX) : v[c]);
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

}  // namespace

void write_exr(std::ostream& out, const Image& image, const Metadata& metadata,
               const std::optional<Noise>& noise, bool bits16) {
  Imf::Header header(image.width, image.height);
  Imf::FrameBuffer frame;
  const Imf::PixelType rgb_type = bits16 ? Imf::HALF : Imf::FLOAT;
  for (const char* name : exr_rgb) header.channels().insert(name, Imf::Channel(rgb_type));
  const std::vector<half> halves = bits16 ? halves_of(image) : std::vector<half>();
  if (bits16)
    add_to(frame, halves.data(), image.width, exr_rgb, header.dataWindow());
  else
    add_to(frame, floats_of(image), image.width, exr_rgb, header.dataWindow());
  if (noise) {
    for (const char* name : exr_variances) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    add_to(frame, floats_of(noise->variance), image.width, exr_variances, header.dataWindow());
    header.insert(exr_freedom, Imf::FloatAttribute(static_cast<float>(noise->freedom)));
  }
  add_metadata(header, metadata);
  StreamOut stream(out);
  Imf::OutputFile file(stream, header, 0);
  file.setFrameBuffer(frame);
  file.writePixels(image.height);
}

}  // namespace castray
