#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "castray/vec.h"

namespace castray {

/// Linear radiance, float RGB, top row first.
struct Image {
  int width = 0, height = 0;
  std::vector<Vec3f> pixels;

  Image() = default;
  Image(int w, int h)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  Vec3f& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  const Vec3f& at(int x, int y) const { return const_cast<Image*>(this)->at(x, y); }
};

/// How many pixels have a component that is NaN or infinite.
std::size_t count_nonfinite(const Image& image);

/// How light becomes a stored value in [0,1]: the curve of IEC 61966-2-1 ("srgb"), the identity ("linear"),
/// or value^exponent ("gamma:EXPONENT").
struct ToneCurve {
  enum class Kind : unsigned char { srgb, linear, gamma };
  Kind kind = Kind::srgb;
  double exponent = 1;  ///< of gamma, > 0

  /// Clamps to [0,1] and encodes; NaN becomes 0, so that it is never mistaken for a highlight.
  double encode(double light) const;
  /// The light in [0,1] that is stored as `value`.
  double decode(double value) const;
  friend bool operator==(const ToneCurve&, const ToneCurve&) = default;
};

/// "srgb", "linear" or "gamma:G". Throws InputError on anything else.
ToneCurve parse_tone_curve(const std::string& text);
std::string to_string(const ToneCurve& tone);

/// How radiance is shown: multiplied by 2^exposure, then encoded.
struct Display {
  ToneCurve tone;
  double exposure = 0;  ///< stops
  bool bits16 = false;  ///< files hold 16 bits a value: .ppm and .png instead of 8, .exr (half) instead of 32
};

/// Radiance as stored values in [0,1].
Image displayed(const Image& radiance, const Display& display);

/// What a file says besides its pixels: scene, spp, seed, seconds, version, ...
using Metadata = std::map<std::string, std::string>;

/// How far an image may be from its expectation.
struct Noise {
  Image variance;  ///< of each value, such that errors of different pixels can be taken for uncorrelated
  double freedom =
      std::numeric_limits<double>::infinity();  ///< of the variance of 8x8 pixels; infinite: exact
  bool of_halves = false;                       ///< the values are stored as half floats
};

/// A channel of an EXR file besides those of the image: a value of each pixel, top row first.
struct ImageChannel {
  std::string name;  ///< in full, "albedo.R"
  bool may_be_half = false;
  std::vector<float> values;
};

/// Channels of an image's size, and what is to be said of them.
struct Passes {
  std::vector<ImageChannel> channels;
  Metadata metadata;
};

/// Pixels as a file stores them, top row first, the channels of a pixel side by side. Alpha, where there is
/// any, is below 1 somewhere; it is multiplied into the colours in EXR only.
struct Raster {
  int width = 0, height = 0;
  int channels = 3;      ///< 1: grey; 2: grey, alpha; 3: red, green, blue; 4: the same and alpha
  bool encoded = false;  ///< values in [0,1] under a tone curve that the file does not tell; else linear
  std::vector<unsigned char> bytes;  ///< files of 8 bits a value, which is byte/255
  std::vector<float> floats;         ///< all other files; one of the two is empty

  bool has_alpha() const { return channels % 2 == 0; }
  float value(std::size_t i) const {
    return bytes.empty() ? floats[i] : static_cast<float>(bytes[i]) / 255.f;
  }
};

/// What a file holds. Formats of 8 or 16 bits a value hold values in [0,1] under a tone curve that the file
/// does not tell, PFM, HDR, EXR and films hold linear radiance.
struct ImageFile {
  Image image;
  bool encoded = false;                    ///< `image` holds stored values in [0,1], not radiance
  Metadata metadata;                       ///< PNG, EXR and film
  std::optional<Noise> noise = {};         ///< EXR, film with replicates, and PFM with a variance_file
  std::vector<float> alpha = {};           ///< of each pixel, as Raster has it; empty: 1 everywhere
  std::vector<std::string> left_out = {};  ///< what else an EXR file holds: layers, pixels outside its window
};

/// Reads .ppm and .pgm (text and binary), .png, .jpg, .tga, .bmp, .gif (its first frame), .psd (8 and 16 bits
/// a value; as stb_image reads these five), .pfm, .hdr, .exr or .film. What a file is, its first bytes say,
/// where they can; the suffix says it else. Grey is widened to RGB.
///
/// EXR: half, float or uint; scanlines or tiles; the display window, black where there are no data. `layer`
/// names the layer to read: what stands before the last dot of its channels' names, or the part's name, or
/// the name of a single channel. Empty: the channels without a layer's name of the first part, else the only
/// layer with R, G and B, else the only channel. R, G, B; Y, RY, BY (half, first part; converted); X, Y, Z;
/// or a single channel, as grey. A file whose only picture has no layer's name is read whatever `layer` is.
///
/// HDR: as its EXPOSURE and COLORCORR say, in any orientation.
///
/// Noise is that of a film's replicates (`noise_of`); in EXR the channels variance.R, variance.G, variance.B
/// with the attribute varianceFreedom (float; none: infinite); of NAME.pfm the file NAME.variance.pfm beside
/// it, if there, taken for exact. Throws InputError that says what is wrong with the file.
ImageFile read_image(const std::filesystem::path& file, const std::string& layer = "");

/// The layer of this name of an EXR file, none where the file has none. Throws InputError.
std::optional<Image> read_layer(const std::filesystem::path& file, const std::string& layer);

/// The same pixels, as the file stores them: for textures, which keep bytes as bytes.
Raster read_raster(const std::filesystem::path& file);

/// The same of the bytes that are the content of `file`, whose name need not tell the format.
Raster parse_raster(const std::filesystem::path& file, std::string_view bytes);

/// The suffix of the format that an image file's first bytes show, ".png"; empty where they show none.
std::string suffix_of_image(std::string_view bytes);

/// Linear radiance: what `file` holds, decoded by `tone` where it is encoded.
Image decoded(const ImageFile& file, const ToneCurve& tone);

/// Writes `image` in the format of the suffix, atomically. `display` shapes .ppm and .png only, but for
/// bits16; there and in .hdr, NaN and negative components are stored as 0. `metadata` is stored in .png and
/// .exr, `noise` and `passes` in .exr. Throws InputError.
void write_image(const std::filesystem::path& file, const Image& image, const Display& display = {},
                 const Metadata& metadata = {}, const std::optional<Noise>& noise = {},
                 const Passes& passes = {});

/// NAME.variance.pfm of NAME.pfm.
std::filesystem::path variance_file(const std::filesystem::path& pfm);
bool is_variance_file(const std::filesystem::path& file);

/// The bytes of a PNG file.
std::string encode_png(const Image& image, const Display& display = {}, const Metadata& metadata = {});

/// Throws InputError if an image or film could not be written to `file`: a suffix of no format that is
/// written (the message lists those), a missing folder, a write-protected target, ... To be asked before work
/// starts.
void check_output_image(const std::filesystem::path& file);

/// Whether the suffix is that of a format that can be read.
bool is_image_format(const std::filesystem::path& file);

/// Whether the suffix is that of a format of encoded values.
bool is_encoded_format(const std::filesystem::path& file);

/// Whether the suffix is that of a format whose files may hold several layers, .exr.
bool has_layers(const std::filesystem::path& file);

/// Whether files of the suffix's format say what `Metadata` says: .exr and .png.
bool holds_metadata(const std::filesystem::path& file);

/// Whether the suffix is .film.
bool is_film_format(const std::filesystem::path& file);

}  // namespace castray
