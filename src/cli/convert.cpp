#include <algorithm>
#include <memory>

#include "castray/error.h"
#include "castray/film.h"
#include "cli/commands.h"
#include "cli/display_flags.h"

namespace castray::cli {

namespace {

struct Convert {
  std::filesystem::path input;
  std::vector<std::filesystem::path> outputs;
  DisplayFlags flags;

  int run() const {
    const Display display = flags.display();
    for (const auto& output : outputs) check_output_image(output);
    const bool any_encoded = std::any_of(outputs.begin(), outputs.end(), is_encoded_format);
    if (flags.exposure != 0 && !any_encoded)
      throw InputError("--exposure shapes .png and .ppm files only, and no output is one; leave it out");
    if (!flags.tone.empty() && !any_encoded && !is_encoded_format(input))
      throw InputError("--tone shapes .png and .ppm files only, and there is none; leave it out");
    if (is_film_format(input) && std::any_of(outputs.begin(), outputs.end(), is_film_format)) {
      const Film film = read_film(input);
      for (const auto& output : outputs) write_film(output, film, display);
      return 0;
    }
    const ImageFile file = read_image(input);
    const Image radiance = decoded(file, display.tone);
    for (const auto& output : outputs) {
      warn_of_nonfinite(radiance, output);
      write_image(output, radiance, display, file.metadata, file.noise);
    }
    return 0;
  }
};

}  // namespace

Run add_convert(Arguments& arguments) {
  auto convert = std::make_shared<Convert>();
  arguments.add_positional("IMAGE", convert->input, "a .ppm, .png, .pfm, .hdr, .exr or .film file")
      .required();
  add_outputs(arguments, convert->outputs);
  convert->flags.add_to(arguments);
  convert->flags.add_bits_to(arguments);
  return [convert] { return convert->run(); };
}

}  // namespace castray::cli
