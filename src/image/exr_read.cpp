#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIO.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <algorithm>
#include <cstring>

#include "castray/error.h"
#include "image/exr_channels.h"
#include "image/exr_layers.h"
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

double width_of(const Imath::Box2i& box) { return double(box.max.x) - box.min.x + 1; }
double height_of(const Imath::Box2i& box) { return double(box.max.y) - box.min.y + 1; }

/// Floats over a window of the plane, 0 where nothing was read.
struct Plane {
  Imath::Box2i window;
  std::size_t channels;
  std::vector<float> values;

  Plane(const Imath::Box2i& over, std::size_t channel_count)
      : window(over),
        channels(channel_count),
        values(channels * static_cast<std::size_t>(width()) * static_cast<std::size_t>(height())) {}
  int width() const { return static_cast<int>(width_of(window)); }
  int height() const { return static_cast<int>(height_of(window)); }
  float* at(int x, int y) {
    const std::size_t row = static_cast<std::size_t>(y - window.min.y) * static_cast<std::size_t>(width());
    return &values[channels * (row + static_cast<std::size_t>(x - window.min.x))];
  }
};

/// The same over another window.
Plane moved(Plane from, const Imath::Box2i& window) {
  if (from.window == window) return from;
  Plane to(window, from.channels);
  const int x0 = std::max(window.min.x, from.window.min.x), x1 = std::min(window.max.x, from.window.max.x);
  for (int y = std::max(window.min.y, from.window.min.y); y <= std::min(window.max.y, from.window.max.y); ++y)
    if (x0 <= x1)
      std::copy_n(from.at(x0, y), to.channels * static_cast<std::size_t>(x1 - x0 + 1), to.at(x0, y));
  return to;
}

/// The channels of these names, side by side.
Plane read_channels(Imf::InputPart& part, const std::vector<std::string>& names) {
  Plane plane(part.header().dataWindow(), names.size());
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const Imf::Channel& channel = *part.header().channels().findChannel(names[c]);
    if (channel.xSampling != 1 || channel.ySampling != 1)
      throw InputError("its channel " + names[c] + " is subsampled, which only Y, RY, BY may be");
    frame.insert(names[c], exr_slice(plane.values.data() + c, plane.channels, plane.width(), plane.window));
  }
  part.setFrameBuffer(frame);
  part.readPixels(plane.window.min.y, plane.window.max.y);
  return plane;
}

/// OpenEXR's own conversion, in halves.
Plane read_luminance_chroma(const std::string& name, std::string_view bytes, const ExrLayer& layer,
                            const Imf::ChannelList& list) {
  if (layer.part > 0) throw InputError("its luminance and chroma (Y RY BY) are not in the first part");
  for (const std::string& channel : layer.channels)
    if (list.findChannel(channel)->type != Imf::HALF)
      throw InputError("its luminance and chroma (Y RY BY) are not half floats; convert it to R G B");
  const std::string& luminance = layer.channels.front();
  const std::size_t dot = luminance.rfind('.');
  BytesIn in(name, bytes);
  Imf::RgbaInputFile file(in, dot == std::string::npos ? "" : luminance.substr(0, dot), 0);
  Plane plane(file.dataWindow(), layer.alpha.empty() ? 3 : 4);
  const Imath::Box2i& window = plane.window;
  std::vector<Imf::Rgba> pixels(static_cast<std::size_t>(plane.width()) *
                                static_cast<std::size_t>(plane.height()));
  file.setFrameBuffer(pixels.data() - window.min.x - std::ptrdiff_t{window.min.y} * plane.width(), 1,
                      static_cast<std::size_t>(plane.width()));
  file.readPixels(window.min.y, window.max.y);
  auto to = plane.values.begin();
  for (const Imf::Rgba& pixel : pixels) {
    const float values[] = {pixel.r, pixel.g, pixel.b, pixel.a};
    to = std::copy_n(values, plane.channels, to);
  }
  return plane;
}

Plane read_layer(const std::string& name, std::string_view bytes, Imf::InputPart& part,
                 const ExrLayer& layer) {
  if (layer.kind == ExrLayer::Kind::luminance_chroma)
    return read_luminance_chroma(name, bytes, layer, part.header().channels());
  std::vector<std::string> channels = layer.channels;
  if (!layer.alpha.empty()) channels.push_back(layer.alpha);
  return read_channels(part, channels);
}

std::vector<ExrPart> parts_of(const Imf::MultiPartInputFile& file) {
  std::vector<ExrPart> parts;
  for (int i = 0; i < file.parts(); ++i) {
    const Imf::Header& header = file.header(i);
    ExrPart part{file.parts() > 1 && header.hasName() ? header.name() : "", {}};
    const Imf::ChannelList& channels = header.channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
      part.channels.emplace_back(channel.name());
    parts.push_back(std::move(part));
  }
  return parts;
}

/// A small file may stand for a large picture that is black but for a few pixels, up to a limit.
void check_display_window(const std::string& name, const Imf::Header& header, std::size_t file_length) {
  constexpr double always_allowed = 0x1p24;
  const Imath::Box2i &display = header.displayWindow(), &data = header.dataWindow();
  const double width = width_of(display), height = height_of(display);
  if (!(width * height <= always_allowed && width >= 1 && height >= 1))
    check_image_size(name, width, height, file_length, exr_pixels_per_byte);
  if (!display.intersects(data)) throw InputError("its data window lies outside its display window");
}

/// OpenEXR takes the memory of a tile, and of a row of tiles, before it reads them.
void check_tiles(const std::string& name, const Imf::Header& header, std::size_t file_length) {
  if (!header.hasTileDescription()) return;
  const Imf::TileDescription& tile = header.tileDescription();
  for (const double width : {double(tile.xSize), width_of(header.dataWindow())})
    check_image_size(name, width, tile.ySize, file_length, exr_pixels_per_byte);
}

/// Whether the first of a layer's channels, and so its colours, are half floats.
bool is_half(const Imf::InputPart& part, const ExrLayer& layer) {
  return part.header().channels().findChannel(layer.channels.front())->type == Imf::HALF;
}

std::optional<Noise> read_noise(Imf::InputPart& part, const ExrLayer& layer) {
  const Imf::ChannelList& channels = part.header().channels();
  if (!std::all_of(exr_variances.begin(), exr_variances.end(),
                   [&](const char* variance) { return channels.findChannel(variance); }))
    return std::nullopt;
  Plane plane =
      moved(read_channels(part, {exr_variances.begin(), exr_variances.end()}), part.header().displayWindow());
  Noise noise{colours_of({plane.width(), plane.height(), 3, false, {}, std::move(plane.values)})};
  if (const auto* freedom = part.header().findTypedAttribute<Imf::FloatAttribute>(exr_freedom))
    noise.freedom = freedom->value();
  noise.of_halves = is_half(part, layer);
  return noise;
}

/// All but what the format itself says in this way.
Metadata texts_of(const Imf::Header& header) {
  Metadata metadata;
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
    if (const std::string name = attribute.name(); name == "type" || name == "name")
      continue;
    else if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
      metadata[name] = text->value();
  return metadata;
}

std::vector<std::string> others(const std::vector<ExrLayer>& layers, const ExrLayer& chosen) {
  std::vector<std::string> names;
  for (const ExrLayer& layer : layers)
    if (&layer != &chosen && !is_variance(layer)) names.push_back("layer " + to_string(layer));
  return names;
}

bool has_layer(const std::string& name, std::string_view bytes, const std::string& layer_name) {
  check_exr_headers(name, bytes);
  BytesIn in(name, bytes);
  const Imf::MultiPartInputFile file(in, 0);
  return std::ranges::any_of(layers_of(parts_of(file)),
                             [&](const ExrLayer& layer) { return layer.name == layer_name; });
}

/// Whether the header says nothing else of what red, green, blue and white are.
bool has_srgb_primaries(const Imf::Header& header) {
  if (!Imf::hasChromaticities(header)) return true;
  constexpr float tolerance = 0.002f;  // 0.3127 is also written as 0.313
  const Imf::Chromaticities srgb, &given = Imf::chromaticities(header);
  return given.red.equalWithAbsError(srgb.red, tolerance) &&
         given.green.equalWithAbsError(srgb.green, tolerance) &&
         given.blue.equalWithAbsError(srgb.blue, tolerance) &&
         given.white.equalWithAbsError(srgb.white, tolerance);
}

Decoded read_from(const std::string& name, std::string_view bytes, const std::string& layer_name) {
  check_exr_headers(name, bytes);
  BytesIn in(name, bytes);
  Imf::MultiPartInputFile file(in, 0);
  const std::vector<ExrLayer> layers = layers_of(parts_of(file));
  const ExrLayer& layer = choose_layer(layers, layer_name);
  const Imf::Header& header = file.header(static_cast<int>(layer.part));
  if (header.hasType() && Imf::isDeepData(header.type()))
    throw InputError("it holds deep pixels, which are not read; flatten it");
  check_display_window(name, header, bytes.size());
  check_tiles(name, header, bytes.size());
  Imf::InputPart part(file, static_cast<int>(layer.part));
  Plane plane = moved(read_layer(name, bytes, part, layer), header.displayWindow());
  Decoded decoded{{plane.width(), plane.height(), static_cast<int>(plane.channels), false, {}, {}}};
  decoded.raster.floats = std::move(plane.values);
  drop_opaque_alpha(decoded.raster);
  decoded.metadata = texts_of(header);
  if (layer.is_plain) decoded.noise = read_noise(part, layer);
  decoded.left_out = others(layers, layer);
  if (!has_srgb_primaries(header)) decoded.left_out.push_back("that its primaries are not those of sRGB");
  Imath::Box2i all = header.displayWindow();
  all.extendBy(header.dataWindow());
  if (all != header.displayWindow()) decoded.left_out.push_back("pixels outside its display window");
  return decoded;
}

/// What `read` finds; its errors become InputErrors of this file.
template <class Read>
auto guarded(const std::string& name, Read read) {
  try {
    return read();
  } catch (const std::exception& error) {
    throw InputError({name}, std::string("cannot be read as OpenEXR: ") + error.what());
  }
}

}  // namespace

Decoded read_exr(const std::string& name, std::string_view bytes, const std::string& layer) {
  return guarded(name, [&] { return read_from(name, bytes, layer); });
}

bool has_exr_layer(const std::string& name, std::string_view bytes, const std::string& layer) {
  return guarded(name, [&] { return has_layer(name, bytes, layer); });
}

}  // namespace castray
