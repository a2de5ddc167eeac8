#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <span>

#include "castray/error.h"
#include "castray/merge_films.h"
#include "cli/commands.h"
#include "cli/display_flags.h"
#include "cli/film_bands.h"
#include "cli/memory_limit.h"
#include "cli/memory_need.h"
#include "core/threads.h"

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
  std::string memory_limit;

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

  std::uint64_t most_bytes() const {
    return memory_limit.empty() ? share_of_memory() : parse_bytes("memory-limit", memory_limit);
  }

  /// What `films` films like the first take in a window of this size, and their image.
  static MemoryNeed need_of(Film first, std::uint64_t films, int width, int height) {
    MemoryNeed need;
    need.scene = bytes_of_program();
    need.films = films;
    need.width = width;
    need.height = height;
    need.threads = available_threads();
    need.like = std::move(first);
    return need;
  }

  /// Whether the sum, one film besides, its file and the image have room in memory.
  bool fits() const {
    Film first = read_film_header(inputs.front());
    const Window w = first.window();
    return need_of(std::move(first), 3, w.full_width, w.full_height).all() <= most_bytes();
  }

  int band_of(const MemoryNeed& need) const {
    const std::uint64_t most = most_bytes(), program = std::min(need.fixed(), most);
    const auto bytes = [&](int rows) { return need.rows(rows); };
    if (const auto band = band_within(most - program, need.margin(), need.height, bytes)) return *band;
    const int least = least_band(need.margin(), need.height);
    if (memory_limit.empty()) return least;
    const std::uint64_t needed = need.in_least_bands();
    throw InputError(more_is_needed(
        most, fmt::format("{} rows of two films and their image take {}", least, bytes_text(needed)),
        needed));
  }

  int merge_in_bands(const Display& display, const CommonFlags& common) const {
    const MergedRows merged(inputs);
    if (!merged.missing().empty()) tell_missing(merged.missing());
    const Window window = merged.window();
    const MemoryNeed need = need_of(read_film_header(inputs.front()), 2, window.width(), window.height());
    Film part;
    const BandedFilm film{window, band_of(need), need.margin(), [&](int y0, int y1) -> const Film& {
                            part = {};  // its memory is needed
                            return part = merged.rows(y0, y1);
                          }};
    write_film_in_bands(outputs, film, display, metadata_of);
    if (common.verbose) tell_written(outputs);
    return 0;
  }

  int run(const CommonFlags& common) const {
    const Display display = flags.display();
    if (!common.quiet) warn_of_darkening(display.tone);
    check_distinct(outputs);
    for (const auto& output : outputs) check_output_image(output);
    if (!fits()) return merge_in_bands(display, common);
    FilmMeter meter;
    const MergedFilm merged = merge_films(inputs, [&](std::size_t done) {
      if (!common.quiet) meter.tell(done, inputs.size());
    });
    if (!merged.missing.empty()) tell_missing(merged.missing);
    write_film(outputs, merged.film, display, metadata_of(merged.film));
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
  arguments.add("--memory-limit", merge->memory_limit, "SIZE",
                "merge some rows at a time rather than take more memory, as in 4G [half of the machine's]");
  add_outputs(arguments, merge->outputs);
  merge->flags.add_to(arguments);
  merge->flags.add_bits_to(arguments);
  return [merge, &common] { return merge->run(common); };
}

}  // namespace castray::cli
