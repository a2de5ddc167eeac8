#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "castray/film.h"
#include "castray/image.h"

namespace castray {

/// What a reader finds in a file.
struct Decoded {
  Raster raster;
  Metadata metadata = {};
  std::optional<Noise> noise = {};
  std::vector<std::string> left_out = {};
};

/// Reading: `bytes` is all of the file; `name` is for messages. Each throws InputError.
Decoded read_netpbm(const std::string& name, std::string_view bytes);  ///< PPM, PGM
Decoded read_pfm(const std::string& name, std::string_view bytes);
Decoded read_png(const std::string& name, std::string_view bytes);
Decoded read_hdr(const std::string& name, std::string_view bytes);
Decoded read_exr(const std::string& name, std::string_view bytes, const std::string& layer);
/// Whether it has a layer of this name.
bool has_exr_layer(const std::string& name, std::string_view bytes, const std::string& layer);
Film parse_film(const std::string& name, std::string_view bytes);

/// By stb_image.
Decoded read_jpeg(const std::string& name, std::string_view bytes);
Decoded read_tga(const std::string& name, std::string_view bytes);
Decoded read_bmp(const std::string& name, std::string_view bytes);
Decoded read_gif(const std::string& name, std::string_view bytes);
Decoded read_psd(const std::string& name, std::string_view bytes);

/// Takes alpha out where it is 1 everywhere.
void drop_opaque_alpha(Raster& raster);

/// Its colours; grey is widened to RGB.
Image colours_of(const Raster& raster);

/// Throws InputError unless an image of this size can be in a file of this length, whose format packs at most
/// `pixels_per_byte`: asked before memory is taken, so that a forged header cannot exhaust it.
void check_image_size(const std::string& name, double width, double height, std::size_t file_length,
                      double pixels_per_byte);

/// As `check_image_size` asks for; the format's compressions pack no more.
inline constexpr double exr_pixels_per_byte = 2000;

/// Throws InputError unless the lengths in an OpenEXR file's headers agree with one another and with the
/// file's. OpenEXR itself takes the memory that they claim before it notices.
void check_exr_headers(const std::string& name, std::string_view bytes);

}  // namespace castray
