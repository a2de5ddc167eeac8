#include "castray/image.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "castray/error.h"
#include "castray/film.h"
#include "core/files.h"
#include "image/formats.h"

namespace castray {

namespace {

QuantisedImage quantised(const Image& image, const Display& display) {
  const Image values = displayed(image, display);
  QuantisedImage result{image.width, image.height, {}, display.bits16 ? 16 : 8};
  result.bytes.reserve((display.bits16 ? 6 : 3) * values.pixels.size());
  for (const Vec3f& v : values.pixels)
    for (int c = 0; c < 3; ++c) {
      const long value = std::lround((display.bits16 ? 65535 : 255) * v[c]);
      if (display.bits16) result.bytes.push_back(static_cast<unsigned char>(value >> 8));
      result.bytes.push_back(static_cast<unsigned char>(value & 255));
    }
  return result;
}

using Read = ImageFile (*)(const std::string& name, std::string_view bytes);
using Write = void (*)(std::ostream& out, const Image& image, const Display& display,
                       const Metadata& metadata, const std::optional<Noise>& noise);

struct Format {
  const char* suffix;
  bool is_encoded;
  Read read;
  Write write;  ///< null: not from an image
};

ImageFile read_film_image(const std::string& name, std::string_view bytes) {
  const Film film = parse_film(name, bytes);
  return {film.image(), false, describe(film), noise_of(film)};
}

using OptionalNoise = const std::optional<Noise>&;

constexpr Format formats[] = {
    {".ppm", true, read_ppm,
     [](std::ostream& out, const Image& image, const Display& display, const Metadata&, OptionalNoise) {
       write_ppm(out, quantised(image, display));
     }},
    {".png", true, read_png,
     [](std::ostream& out, const Image& image, const Display& display, const Metadata& metadata,
        OptionalNoise) { write_png(out, quantised(image, display), metadata); }},
    {".pfm", false, read_pfm,
     [](std::ostream& out, const Image& image, const Display&, const Metadata&, OptionalNoise) {
       write_pfm(out, image);
     }},
    {".hdr", false, read_hdr,
     [](std::ostream& out, const Image& image, const Display&, const Metadata&, OptionalNoise) {
       write_hdr(out, image);
     }},
    {".exr", false, read_exr,
     [](std::ostream& out, const Image& image, const Display& display, const Metadata& metadata,
        OptionalNoise noise) { write_exr(out, image, metadata, noise, display.bits16); }},
    {".film", false, read_film_image, nullptr},
};

/// Null where the suffix is unknown.
const Format* find_format(const std::filesystem::path& file) {
  std::string suffix = file.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto* found = std::find_if(std::begin(formats), std::end(formats),
                                   [&](const Format& f) { return suffix == f.suffix; });
  return found == std::end(formats) ? nullptr : found;
}

const Format& format_of(const std::filesystem::path& file) {
  if (const Format* format = find_format(file)) return *format;
  const std::string suffix = file.extension().string();
  std::string known;
  for (const Format& format : formats) known += std::string(known.empty() ? "" : " ") + format.suffix;
  throw InputError(
      {file.string()},
      (suffix.empty() ? "has no suffix" : "unknown image format '" + suffix + "'") + "; known are " + known);
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

ImageFile read_image(const std::filesystem::path& file) {
  const Format& format = format_of(file);
  const std::string bytes = read_file(file);
  ImageFile result = format.read(file.string(), bytes);
  if (const auto beside = variance_file(file); format.read == read_pfm && std::filesystem::exists(beside))
    result.noise = Noise{read_pfm(beside.string(), read_file(beside)).image};
  return result;
}

void write_image(const std::filesystem::path& file, const Image& image, const Display& display,
                 const Metadata& metadata, const std::optional<Noise>& noise) {
  const Format& format = format_of(file);
  if (!format.write)
    throw InputError({file.string()}, "a film holds samples, which an image has not; choose another format");
  write_file(file, [&](std::ostream& out) { format.write(out, image, display, metadata, noise); });
}

std::string encode_png(const Image& image, const Display& display, const Metadata& metadata) {
  std::ostringstream out;
  write_png(out, quantised(image, display), metadata);
  return std::move(out).str();
}

void check_output_image(const std::filesystem::path& file) {
  check_writable(file);
  format_of(file);
}

std::filesystem::path variance_file(const std::filesystem::path& pfm) {
  return std::filesystem::path(pfm).replace_extension(".variance.pfm");
}

bool is_variance_file(const std::filesystem::path& file) {
  return file.filename().string().ends_with(".variance.pfm");
}

bool is_image_format(const std::filesystem::path& file) { return find_format(file); }
bool is_encoded_format(const std::filesystem::path& file) { return format_of(file).is_encoded; }
bool is_film_format(const std::filesystem::path& file) { return !format_of(file).write; }

}  // namespace castray
