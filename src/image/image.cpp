#include "castray/image.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "castray/error.h"
#include "castray/film.h"
#include "core/files.h"
#include "image/formats.h"
#include "image/row_writer.h"

namespace castray {

namespace {

using Read = Decoded (*)(const std::string& name, std::string_view bytes, const std::string& layer);
using Write = std::unique_ptr<RowWriter> (*)(std::ostream& out, const WrittenImage& image);

struct Format {
  const char* suffix;
  std::string_view signature;  ///< what files begin with; empty: the suffix alone tells
  bool is_encoded;
  Read read;    ///< null: a film
  Write write;  ///< null: not from an image
};

/// A reader of a format without layers.
template <Decoded (*read)(const std::string&, std::string_view)>
constexpr Read plain =
    [](const std::string& name, std::string_view bytes, const std::string&) { return read(name, bytes); };

constexpr Format formats[] = {
    {".ppm", "P6", true, plain<read_netpbm>, write_ppm},
    {".png", "\x89PNG", true, plain<read_png>, write_png},
    {".pfm", "PF", false, plain<read_pfm>, write_pfm},
    {".hdr", "#?", false, plain<read_hdr>, write_hdr},
    {".exr", "\x76\x2f\x31\x01", false, read_exr, write_exr},
    {".film", "", false, nullptr, nullptr},
    {".jpg", "\xff\xd8\xff", true, plain<read_jpeg>, nullptr},
    {".jpeg", "", true, plain<read_jpeg>, nullptr},
    {".tga", "", true, plain<read_tga>, nullptr},
    {".bmp", "BM", true, plain<read_bmp>, nullptr},
    {".gif", "GIF8", true, plain<read_gif>, nullptr},
    {".psd", "8BPS", true, plain<read_psd>, nullptr},
    {".pgm", "P5", true, plain<read_netpbm>, nullptr},
    {".pnm", "", true, plain<read_netpbm>, nullptr},
    {".rgbe", "", false, plain<read_hdr>, nullptr},
};

bool is_film(const Format& format) { return !format.read; }
bool is_written(const Format& format) { return format.write || is_film(format); }

/// That of the format: of the standard output that which its name begins with ("exr:-"), else .png.
std::string format_suffix(const std::filesystem::path& file) {
  if (!is_standard_output(file)) return suffix_of(file);
  const std::string name = file.string();
  return name.ends_with(":-") ? "." + name.substr(0, name.size() - 2) : ".png";
}

/// Null where the suffix is unknown.
const Format* find_format(const std::filesystem::path& file) {
  const std::string suffix = format_suffix(file);
  const auto* found = std::find_if(std::begin(formats), std::end(formats),
                                   [&](const Format& f) { return suffix == f.suffix; });
  return found == std::end(formats) ? nullptr : found;
}

template <class Included>
std::string suffixes(Included included) {
  std::string list;
  for (const Format& format : formats)
    if (included(format)) list += std::string(list.empty() ? "" : " ") + format.suffix;
  return list;
}

const Format& format_of(const std::filesystem::path& file) {
  if (const Format* format = find_format(file)) return *format;
  const std::string suffix = format_suffix(file);
  throw InputError({file.string()},
                   (suffix.empty() ? "has no suffix" : "unknown image format '" + suffix + "'") +
                       "; known are " + suffixes([](const Format&) { return true; }));
}

/// What the file's first bytes say, else what its suffix says: files are often named wrongly.
const Format& format_of(const std::filesystem::path& file, std::string_view bytes) {
  if (const Format* named = find_format(file); named && is_film(*named)) return *named;
  for (const Format& format : formats)
    if (!format.signature.empty() && bytes.starts_with(format.signature)) return format;
  return format_of(file);
}

const Format& writable_format_of(const std::filesystem::path& file) {
  const Format* format = find_format(file);
  if (format && is_written(*format)) return *format;
  const std::string suffix = format_suffix(file);
  throw InputError({file.string()}, (suffix.empty() ? "has no suffix"
                                     : format       ? "images of '" + suffix + "' are read only"
                                                    : "unknown image format '" + suffix + "'") +
                                        "; written are " + suffixes(is_written));
}

ImageFile image_of_film(const Film& film) { return {image_of(film), false, describe(film), noise_of(film)}; }

std::vector<float> alpha_of(const Raster& raster) {
  std::vector<float> alpha;
  const auto channels = static_cast<std::size_t>(raster.channels);
  const std::size_t values = std::max(raster.bytes.size(), raster.floats.size());
  if (raster.has_alpha())
    for (std::size_t i = channels - 1; i < values; i += channels) alpha.push_back(raster.value(i));
  return alpha;
}

}  // namespace

std::size_t count_nonfinite(const Image& image) {
  return static_cast<std::size_t>(
      std::count_if(image.pixels.begin(), image.pixels.end(), [](const Vec3f& v) { return !is_finite(v); }));
}

void check_image_size(const std::string& name, double width, double height, std::size_t file_length,
                      double pixels_per_byte) {
  if (!(width >= 1 && height >= 1)) throw InputError({name}, "the image has no pixels");
  if (width * height > 0x1p28) throw InputError({name}, "the image has more than 2^28 pixels");
  if (width * height > 4096 + pixels_per_byte * static_cast<double>(file_length))
    throw InputError({name}, "the file is too short for its size in pixels; it is truncated or corrupt");
}

ImageFile read_image(const std::filesystem::path& file, const std::string& layer) {
  const std::string bytes = read_file(file);
  const Format& format = format_of(file, bytes);
  if (is_film(format)) return image_of_film(parse_film(file.string(), bytes));
  Decoded decoded = format.read(file.string(), bytes, layer);
  ImageFile result{colours_of(decoded.raster), decoded.raster.encoded,   std::move(decoded.metadata),
                   std::move(decoded.noise),   alpha_of(decoded.raster), std::move(decoded.left_out)};
  const auto beside = variance_file(file);
  if (find_format(file) == find_format("a.pfm") && std::filesystem::exists(beside))
    result.noise = Noise{colours_of(read_pfm(beside.string(), read_file(beside)).raster)};
  return result;
}

std::optional<Image> read_layer(const std::filesystem::path& file, const std::string& layer) {
  const std::string bytes = read_file(file);
  if (!has_exr_layer(file.string(), bytes, layer)) return std::nullopt;
  return colours_of(read_exr(file.string(), bytes, layer).raster);
}

Raster read_raster(const std::filesystem::path& file) { return parse_raster(file, read_file(file)); }

Raster parse_raster(const std::filesystem::path& file, std::string_view bytes) {
  const Format& format = format_of(file, bytes);
  if (is_film(format)) throw InputError({file.string()}, "is a film; convert it to an image first");
  return format.read(file.string(), bytes, "").raster;
}

std::string suffix_of_image(std::string_view bytes) {
  for (const Format& format : formats)
    if (!format.signature.empty() && bytes.starts_with(format.signature)) return format.suffix;
  return "";
}

std::vector<unsigned char> quantised(std::span<const Vec3f> row, const Display& display) {
  const double factor = std::exp2(display.exposure);
  std::vector<unsigned char> bytes;
  bytes.reserve((display.bits16 ? 6 : 3) * row.size());
  for (const Vec3f& pixel : row)
    for (int c = 0; c < 3; ++c) {
      const auto shown = static_cast<float>(display.tone.encode(pixel[c] * factor));
      const long value = std::lround((display.bits16 ? 65535 : 255) * shown);
      if (display.bits16) bytes.push_back(static_cast<unsigned char>(value >> 8));
      bytes.push_back(static_cast<unsigned char>(value & 255));
    }
  return bytes;
}

std::unique_ptr<RowWriter> row_writer(const std::filesystem::path& file, std::ostream& out,
                                      const WrittenImage& image) {
  const Format& format = writable_format_of(file);
  if (!format.write)
    throw InputError({file.string()}, "a film holds samples, which an image has not; choose another format");
  return format.write(out, image);
}

void write_image(const std::filesystem::path& file, const Image& image, const Display& display,
                 const Metadata& metadata, const std::optional<Noise>& noise, const Passes& passes) {
  const WrittenImage written{image.width, image.height, display, metadata, noise, passes};
  write_file(file, [&](std::ostream& out) {
    const auto writer = row_writer(file, out, written);
    writer->add(image);
    writer->finish();
  });
}

std::string encode_png(const Image& image, const Display& display, const Metadata& metadata) {
  std::ostringstream out;
  const std::optional<Noise> none;
  const Passes no_passes;
  const auto writer = write_png(out, {image.width, image.height, display, metadata, none, no_passes});
  writer->add(image);
  writer->finish();
  return std::move(out).str();
}

void check_output_image(const std::filesystem::path& file) {
  check_writable(file);
  writable_format_of(file);
}

std::filesystem::path variance_file(const std::filesystem::path& pfm) {
  return std::filesystem::path(pfm).replace_extension(".variance.pfm");
}

bool is_variance_file(const std::filesystem::path& file) {
  return file.filename().string().ends_with(".variance.pfm");
}

bool is_image_format(const std::filesystem::path& file) { return find_format(file); }
bool is_encoded_format(const std::filesystem::path& file) { return format_of(file).is_encoded; }
bool has_layers(const std::filesystem::path& file) { return format_of(file).read == read_exr; }
bool holds_metadata(const std::filesystem::path& file) {
  const Write write = format_of(file).write;
  return write == write_exr || write == write_png;
}
bool is_film_format(const std::filesystem::path& file) { return is_film(format_of(file)); }

}  // namespace castray
