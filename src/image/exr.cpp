#include <half.h>
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ostream>
#include <type_traits>

#include "castray/error.h"
#include "image/formats.h"

namespace castray {

namespace {

class BytesIn : public Imf::IStream {
 public:
  BytesIn(const std::string& name, std::string_view bytes) : IStream(name.c_str()), bytes_(bytes) {}
  bool read(char* to, int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (at_ > bytes_.size() || bytes_.size() - at_ < n) throw InputError("it is truncated");
    std::memcpy(to, bytes_.data() + at_, n);
    at_ += n;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

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

constexpr std::array<const char*, 3> rgb = {"R", "G", "B"};
constexpr std::array<const char*, 3> variances = {"variance.R", "variance.G", "variance.B"};
constexpr const char* freedom_name = "varianceFreedom";

/// The names of the channels for red, green and blue: R, G, B, or Y for all three.
std::array<const char*, 3> channels_of(const Imf::ChannelList& channels) {
  if (channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B")) return rgb;
  if (channels.findChannel("Y")) return {"Y", "Y", "Y"};
  std::string found;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel)
    found += std::string(found.empty() ? "" : ", ") + channel.name();
  throw InputError("it has neither channels R, G, B nor Y, but " + (found.empty() ? "none" : found));
}

/// Adds three channels, interleaved. (A frame buffer takes writable memory, though writing only reads it.)
template <class T>
void add_to(Imf::FrameBuffer& frame, const T* values, int width, const std::array<const char*, 3>& names,
            const Imath::Box2i& window) {
  constexpr Imf::PixelType type = std::is_same_v<T, half> ? Imf::HALF : Imf::FLOAT;
  for (std::size_t c = 0; c < 3; ++c)
    frame.insert(names[c], Imf::Slice::Make(type, values + c, window, 3 * sizeof(T),
                                            3 * sizeof(T) * static_cast<std::size_t>(width)));
}

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

bool has_variances(const Imf::ChannelList& channels) {
  return std::all_of(variances.begin(), variances.end(),
                     [&](const char* v) { return channels.findChannel(v); });
}

ImageFile read_from(const std::string& name, std::string_view bytes) {
  check_exr_headers(name, bytes);
  BytesIn in(name, bytes);
  Imf::InputFile file(in, 0);
  const Imf::Header& header = file.header();
  const Imath::Box2i window = header.dataWindow();
  const double width = double(window.max.x) - window.min.x + 1,
               height = double(window.max.y) - window.min.y + 1;
  check_image_size(name, width, height, bytes.size(), exr_pixels_per_byte);
  const auto names = channels_of(header.channels());
  ImageFile result{Image(static_cast<int>(width), static_cast<int>(height)), false, {}};
  Image& image = result.image;
  Imf::FrameBuffer frame;
  add_to(frame, floats_of(image), image.width, names, window);
  if (has_variances(header.channels())) {
    result.noise = Noise{Image(image.width, image.height)};
    add_to(frame, floats_of(result.noise->variance), image.width, variances, window);
    if (const auto* freedom = header.findTypedAttribute<Imf::FloatAttribute>(freedom_name))
      result.noise->freedom = freedom->value();
  }
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  if (names[0] == names[1])
    for (Vec3f& v : image.pixels) v = Vec3f(v.z);
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
      result.metadata[attribute.name()] = text->value();
  return result;
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

ImageFile read_exr(const std::string& name, std::string_view bytes) {
  try {
    return read_from(name, bytes);
  } catch (const std::exception& error) {
    throw InputError({name}, std::string("cannot be read as OpenEXR: ") + error.what());
  }
}

void write_exr(std::ostream& out, const Image& image, const Metadata& metadata,
               const std::optional<Noise>& noise, bool bits16) {
  Imf::Header header(image.width, image.height);
  Imf::FrameBuffer frame;
  const Imf::PixelType rgb_type = bits16 ? Imf::HALF : Imf::FLOAT;
  for (const char* name : rgb) header.channels().insert(name, Imf::Channel(rgb_type));
  const std::vector<half> halves = bits16 ? halves_of(image) : std::vector<half>();
  if (bits16)
    add_to(frame, halves.data(), image.width, rgb, header.dataWindow());
  else
    add_to(frame, floats_of(image), image.width, rgb, header.dataWindow());
  if (noise) {
    for (const char* name : variances) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    add_to(frame, floats_of(noise->variance), image.width, variances, header.dataWindow());
    header.insert(freedom_name, Imf::FloatAttribute(static_cast<float>(noise->freedom)));
  }
  add_metadata(header, metadata);
  StreamOut stream(out);
  Imf::OutputFile file(stream, header, 0);
  file.setFrameBuffer(frame);
  file.writePixels(image.height);
}

}  // namespace castray
