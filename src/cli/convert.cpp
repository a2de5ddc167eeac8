#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "castray/error.h"
#include "castray/film.h"
#include "cli/commands.h"
#include "cli/display_flags.h"
#include "cli/scene_conversion.h"

namespace castray::cli {

namespace {

struct Convert {
  std::filesystem::path input;
  std::vector<std::filesystem::path> outputs;
  DisplayFlags flags;
  std::string layer;

  void warn_of_left_out(const ImageFile& file) const {
    std::vector<std::string> left_out = file.left_out;
    if (!file.alpha.empty()) left_out.insert(left_out.begin(), "alpha");
    if (!left_out.empty())
      fmt::print(stderr, "castray: warning: {}: left out: {}\n", input.string(), fmt::join(left_out, ", "));
  }

  int run_scene(const CommonFlags& common) const {
    if (outputs.size() != 1) throw InputError("a scene becomes one scene file; give one -o FILE.json");
    if (flags.given() || flags.bits != "auto" || !layer.empty())
      throw InputError("--exposure, --tone, --bits and --layer are for images; leave them out");
    convert_scene_file(input, outputs.front(), common);
    return 0;
  }

  int run(const CommonFlags& common) const {
    if (is_convertible_scene(input)) return run_scene(common);
    const Display display = flags.display();
    if (!common.quiet) warn_of_darkening(display.tone);
    check_distinct(outputs);
    for (const auto& output : outputs) check_output_image(output);
    const bool any_encoded = std::any_of(outputs.begin(), outputs.end(), is_encoded_format);
    if (flags.exposure != 0 && !any_encoded)
      throw InputError("--exposure shapes .png and .ppm files only, and no output is one; leave it out");
    if (!flags.tone.empty() && !any_encoded && !is_encoded_format(input))
      throw InputError("--tone shapes .png and .ppm files only, and there is none; leave it out");
    if (!layer.empty() && !has_layers(input))
      throw InputError("--layer: only .exr files have layers; leave it out");
    if (is_film_format(input) && std::any_of(outputs.begin(), outputs.end(), is_film_format)) {
      const Film film = read_film(input);
      write_film(outputs, film, display, metadata_of(film));
      return tell_outputs(common);
    }
    ImageFile file = read_image(input, layer);
    if (is_film_format(input)) add_writer(file.metadata);
    if (!common.quiet) warn_of_left_out(file);
    const Image radiance = decoded(file, display.tone);
    for (const auto& output : outputs) {
      if (!common.quiet) warn_of_nonfinite(radiance, output);
      write_image(output, radiance, display, file.metadata, file.noise);
    }
    return tell_outputs(common);
  }

  int tell_outputs(const CommonFlags& common) const {
    if (common.verbose) tell_written(outputs);
    return 0;
  }
};

}  // namespace

Run add_convert(Arguments& arguments, const CommonFlags& common) {
  auto convert = std::make_shared<Convert>();
  arguments
      .add_positional(
          "FILE", convert->input,
          "an image: .exr .pfm .hdr .film .png .ppm .jpg .tga .bmp .gif or .psd; or a scene, .gltf .glb .obj "
          "or .ply, which becomes a scene file .json")
      .required();
  add_outputs(arguments, convert->outputs);
  arguments.add("--layer", convert->layer, "NAME", layer_help);
  convert->flags.add_to(arguments);
  convert->flags.add_bits_to(arguments);
  return [convert, &common] { return convert->run(common); };
}

}  // namespace castray::cli
