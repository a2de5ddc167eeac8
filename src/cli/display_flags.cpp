#include "cli/display_flags.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <system_error>

#include "castray/error.h"
#include "cli/values.h"
#include "core/files.h"

namespace castray::cli {

void DisplayFlags::add_to(Arguments& arguments) {
  arguments.add("--exposure", exposure, "STOPS", "multiply by 2^STOPS before encoding");
  arguments.add("--tone", tone, "CURVE",
                "curve of encoded pictures: srgb (default), linear, or gamma:G for value^G, which brightens "
                "where G < 1");
}

void DisplayFlags::add_bits_to(Arguments& arguments) { arguments.add("--bits", bits, "auto|16", bits_help); }

bool parse_bits(const std::string& flag, const std::string& text) {
  return parse_choice<bool>(flag, text, {{"auto", false}, {"16", true}});
}

void warn_of_darkening(const ToneCurve& tone) {
  if (tone.kind == ToneCurve::Kind::gamma && tone.exponent > 1)
    fmt::print(stderr,
               "castray: warning: --tone gamma:{0:g}: value^{0:g} darkens; a display of gamma {0:g} needs "
               "gamma:{1:.4g}\n",
               tone.exponent, 1 / tone.exponent);
}

Display DisplayFlags::display() const {
  if (!(std::abs(exposure) <= 100)) throw InputError("--exposure: give stops between -100 and 100");
  return {tone.empty() ? ToneCurve{} : parse_tone_curve(tone), exposure, parse_bits("bits", bits)};
}

void add_outputs(Arguments& arguments, std::vector<std::filesystem::path>& files) {
  arguments
      .add("-o,--output", files, "FILE", "write here; may be repeated; .ppm .png .pfm .hdr .exr or .film")
      .required();
}

void check_distinct(const std::vector<std::filesystem::path>& files) {
  if (std::count_if(files.begin(), files.end(), is_standard_output) > 1)
    throw InputError("more than one output goes to the standard output; give the others names of files");
  std::set<std::filesystem::path> targets;
  for (const auto& file : files) {
    std::error_code ignored;
    if (file.empty() || is_standard_output(file)) continue;
    const bool is_device = std::filesystem::is_other(file, ignored);
    if (!is_device &&
        !targets.insert(std::filesystem::weakly_canonical(std::filesystem::absolute(file), ignored)).second)
      throw InputError({file.string()},
                       "more than one output goes to this file; give the others other names");
  }
}

void add_writer(Metadata& metadata) {
  metadata["Software"] = "castray " CASTRAY_VERSION;
  metadata["castray:version"] = CASTRAY_VERSION;
}

Metadata metadata_of(const Film& film) {
  Metadata metadata = describe(film);
  add_writer(metadata);
  std::string& options = metadata["castray:options"];
  const bool all_samples =
      film.samples.size() == 1 && film.samples.front().first == 0 && film.missing_samples() == 0;
  if (all_samples && options.find("--target-error") == options.npos)
    options += fmt::format(" --spp {}", film.samples.front().count);
  return metadata;
}

void tell_written(const std::vector<std::filesystem::path>& files) {
  for (const auto& file : files) fmt::print(stderr, "wrote {}\n", file.string());
}

void warn_of_nonfinite(const Image& image, const std::filesystem::path& file) {
  const std::size_t count = count_nonfinite(image);
  if (count > 0 && is_encoded_format(file))
    fmt::print(stderr, "castray: warning: {}: {} pixels are not finite; NaN is shown black\n", file.string(),
               count);
}

}  // namespace castray::cli
