#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "castray/denoise.h"
#include "castray/error.h"
#include "cli/commands.h"
#include "cli/display_flags.h"
#include "cli/phase.h"
#include "core/files.h"

namespace castray::cli {

namespace {

/// What an image says of the surfaces that it shows.
struct Guides {
  std::optional<Image> albedo, normal;

  /// Those behind mirrors, if there are any; else those of first hits.
  static Guides of(const std::filesystem::path& file) {
    return {first_layer(file, {"denoising_albedo", "albedo"}), first_layer(file, {"denoising_normal", "N"})};
  }
  std::string text() const {
    return !albedo ? "" : normal ? ", guided by albedo and normals" : ", guided by albedo";
  }

 private:
  static std::optional<Image> first_layer(const std::filesystem::path& file,
                                          const std::vector<std::string>& names) {
    for (const std::string& name : names)
      if (std::optional<Image> image = read_layer(file, name)) return image;
    return std::nullopt;
  }
};

struct Denoise {
  std::filesystem::path input;
  std::vector<std::filesystem::path> outputs;
  DisplayFlags flags;

  void check() const {
    check_distinct(outputs);
    for (const auto& output : outputs) {
      check_output_image(output);
      if (!holds_metadata(output))
        throw InputError({output.string()},
                         "cannot say that its image is biased; write .exr or .png, and convert that");
    }
    if (!has_layers(input))
      throw InputError({input.string()}, "is no .exr file, which radiance and passes are in");
  }

  int run(const CommonFlags& common) const {
    const Display display = flags.display();
    if (!common.quiet) warn_of_darkening(display.tone);
    check();
    const char* library = std::getenv("CASTRAY_OIDN");
    const Denoiser denoiser(library ? library : "");
    ImageFile file = read_image(input);
    if (const std::size_t bad = count_nonfinite(file.image))
      throw InputError({input.string()}, fmt::format("has {} pixels that are not finite", bad));
    refuse_denoised(input, file.metadata, "denoise the image that it was made of");
    const Guides guides = Guides::of(input);
    file.metadata[denoised_key] = denoiser.name() + guides.text();
    file.metadata["castray:biased"] = "denoised";
    Image image;
    {
      const Phase phase(common.quiet ? ProgressMode::off : ProgressMode::automatic, "denoising");
      image = denoiser.denoise(file.image, guides.albedo, guides.normal);
    }
    for (const auto& output : outputs) write_image(output, image, display, file.metadata);
    if (!common.quiet) fmt::print(stderr, "biased: {}\n", file.metadata[denoised_key]);
    if (common.verbose) tell_written(outputs);
    return 0;
  }
};

}  // namespace

Run add_denoise(Arguments& arguments, const CommonFlags& common) {
  auto denoise = std::make_shared<Denoise>();
  arguments.add_positional("IMAGE", denoise->input, "an .exr file, best with 'render --passes denoising'")
      .required();
  add_outputs(arguments, denoise->outputs);
  denoise->flags.add_to(arguments);
  denoise->flags.add_bits_to(arguments);
  arguments.footer(
      "Needs Intel's Open Image Denoise, which is loaded from where the system has libraries, or from the "
      "path in "
      "CASTRAY_OIDN. What it makes is biased and says so: no z-test and no reference takes it.");
  return [denoise, &common] { return denoise->run(common); };
}

}  // namespace castray::cli
