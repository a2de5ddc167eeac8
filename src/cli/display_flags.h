#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "castray/film.h"
#include "castray/image.h"
#include "cli/arguments.h"

namespace castray::cli {

/// --exposure, --tone and --bits, as the user gave them.
struct DisplayFlags {
  double exposure = 0;
  std::string tone;  ///< empty: not given

  std::string bits = "auto";

  void add_to(Arguments& arguments);
  void add_bits_to(Arguments& arguments);  ///< for commands that write images
  bool given() const { return exposure != 0 || !tone.empty(); }
  /// Throws InputError where a value cannot be.
  Display display() const;
};

/// Says on stderr where a curve darkens though its G, as a display's gamma, seems meant to brighten.
void warn_of_darkening(const ToneCurve& tone);

/// The value of --bits: whether files hold 16 bits a value.
bool parse_bits(const std::string& flag, const std::string& text);
inline constexpr const char* bits_help =
    "16: .ppm, .png and .exr hold 16 bits a value [auto: .ppm and .png 8, .exr 32]";

inline constexpr const char* layer_help = "of an EXR file with several layers, such as ViewLayer.Combined";

/// -o FILE, repeatable and required.
void add_outputs(Arguments& arguments, std::vector<std::filesystem::path>& files);

/// Throws InputError where two outputs are one file, or both the standard output: one would be lost.
void check_distinct(const std::vector<std::filesystem::path>& files);

/// Adds that this program wrote the file.
void add_writer(Metadata& metadata);

/// What PNG and EXR files of a film hold: what it says of itself, who wrote them, and, where it has all
/// samples from the first on, their number among the flags that render it again.
Metadata metadata_of(const Film& film);

/// Says on stderr which files were written.
void tell_written(const std::vector<std::filesystem::path>& files);

/// Says on stderr how many pixels of an image for display are not finite, and what is shown in their place.
void warn_of_nonfinite(const Image& image, const std::filesystem::path& file);

}  // namespace castray::cli
