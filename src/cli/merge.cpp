#include <memory>

#include "castray/error.h"
#include "castray/film.h"
#include "cli/commands.h"
#include "cli/display_flags.h"

namespace castray::cli {

namespace {

struct Merge {
  std::vector<std::filesystem::path> inputs, outputs;
  DisplayFlags flags;

  int run(const CommonFlags& common) const {
    const Display display = flags.display();
    if (!common.quiet) warn_of_darkening(display.tone);
    check_one_standard_output(outputs);
    for (const auto& output : outputs) check_output_image(output);
    Film whole = read_film(inputs.front());
    for (std::size_t i = 1; i < inputs.size(); ++i) {
      const Film part = read_film(inputs[i]);
      try {
        whole.merge(part);
      } catch (const InputError& error) {
        throw InputError({inputs[i].string()}, "cannot be merged with " + inputs.front().string() +
                                                   (i > 1 ? " and those between: " : ": ") + error.what());
      }
    }
    for (const auto& output : outputs) write_film(output, whole, display, describe(whole));
    if (common.verbose) tell_written(outputs);
    return 0;
  }
};

}  // namespace

Run add_merge(Arguments& arguments, const CommonFlags& common) {
  auto merge = std::make_shared<Merge>();
  arguments.add_positional("FILM", merge->inputs, "films of disjoint --samples ranges of one render")
      .required();
  add_outputs(arguments, merge->outputs);
  merge->flags.add_to(arguments);
  merge->flags.add_bits_to(arguments);
  return [merge, &common] { return merge->run(common); };
}

}  // namespace castray::cli
