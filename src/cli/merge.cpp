#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <span>

#include "castray/error.h"
#include "castray/merge_films.h"
#include "cli/commands.h"
#include "cli/display_flags.h"

namespace castray::cli {

namespace {

/// Says on stderr how many films are added, every few seconds.
class FilmMeter {
 public:
  void tell(std::size_t done, std::size_t all) {
    const Clock::time_point now = Clock::now();
    if (now - told_ < std::chrono::seconds(3)) return;
    told_ = now;
    fmt::print(stderr, "castray: {} of {} films\n", done, all);
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point told_ = Clock::now();
};

struct Merge {
  std::vector<std::filesystem::path> inputs, outputs;
  DisplayFlags flags;
  bool partial = false;

  /// Throws InputError unless what is there shall do.
  void tell_missing(const std::vector<std::string>& missing) const {
    constexpr std::size_t most = 8;
    const auto shown = std::span(missing).first(std::min(missing.size(), most));
    std::string text = fmt::format("{}", fmt::join(shown, ", "));
    if (missing.size() > most) text += fmt::format(" and {} more", missing.size() - most);
    if (!partial)
      throw InputError("missing: " + text + "; render them, or give --partial to merge what is there");
    fmt::print(stderr, "castray: warning: missing: {}\n", text);
  }

  int run(const CommonFlags& common) const {
    const Display display = flags.display();
    if (!common.quiet) warn_of_darkening(display.tone);
    check_one_standard_output(outputs);
    for (const auto& output : outputs) check_output_image(output);
    FilmMeter meter;
    const MergedFilm merged = merge_films(inputs, [&](std::size_t done) {
      if (!common.quiet) meter.tell(done, inputs.size());
    });
    if (!merged.missing.empty()) tell_missing(merged.missing);
    write_film(outputs, merged.film, display, describe(merged.film));
    if (common.verbose) tell_written(outputs);
    return 0;
  }
};

}  // namespace

Run add_merge(Arguments& arguments, const CommonFlags& common) {
  auto merge = std::make_shared<Merge>();
  arguments
      .add_positional("FILM", merge->inputs, "films of one render: --part, or disjoint --samples or --crop")
      .required();
  arguments.add_switch("--partial", merge->partial, "merge what is there where parts are missing");
  add_outputs(arguments, merge->outputs);
  merge->flags.add_to(arguments);
  merge->flags.add_bits_to(arguments);
  return [merge, &common] { return merge->run(common); };
}

}  // namespace castray::cli
