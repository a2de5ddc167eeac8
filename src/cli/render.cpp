#include <fmt/core.h>

#include <chrono>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "cli/display_flags.h"
#include "cli/film_bands.h"
#include "cli/interrupt.h"
#include "cli/memory_limit.h"
#include "cli/memory_need.h"
#include "cli/render_command.h"
#include "cli/render_passes.h"
#include "cli/render_report.h"
#include "cli/render_run.h"
#include "core/files.h"

namespace castray::cli {

namespace {

double seconds_since(RenderRun::Clock::time_point begin) {
  return std::chrono::duration<double>(RenderRun::Clock::now() - begin).count();
}

/// Whether the render came to the end that was asked for.
bool is_as_asked(const RenderRequest& request, Stopped stopped) {
  if (request.options.target_error) return stopped == Stopped::target_error;
  return stopped == Stopped::done || (stopped == Stopped::time_limit && request.until_time_limit);
}

/// Where the whole film does not fit, and how many rows at a time do.
std::optional<int> rows_at_a_time(const RenderRequest& request, const MemoryNeed& need) {
  const std::uint64_t most = request.memory_limit.value_or(share_of_memory());
  if (need.all() <= most) return std::nullopt;
  const std::string flag = goes_with_no_bands(request);
  const auto band = flag.empty() && need.fixed() < most
                        ? band_within(most - need.fixed(), need.margin(), need.height,
                                      [&](int rows) { return need.rows(rows); })
                        : std::nullopt;
  if (band || !request.memory_limit) return band;  // without a limit it may fit all the same
  const std::string what = "more is needed: " + need.text();
  if (flag.empty()) throw InputError(more_is_needed(most, what, need.in_least_bands()));
  throw InputError(more_is_needed(
      most,
      fmt::format("{}; {} cannot go with an image in bands: render --crop windows and merge their films",
                  what, flag),
      need.all()));
}

/// The result is written without the limit, so that it is not lost.
RenderResult run_limited(RenderRun& run, const RenderRequest& request, const Scene& scene) {
  const MemoryNeed need = memory_need(scene, request);
  if (request.verbose) fmt::print(stderr, "castray: memory: {}\n", need.text());
  const std::optional<int> band = rows_at_a_time(request, need);
  RenderResult result;
  {
    std::optional<MemoryLimit> limit;
    if (request.memory_limit) limit.emplace(*request.memory_limit, need.threads);
    if (band) return run.run_in_bands(scene, *band, need.margin());
    result = run.run(scene);
  }
  run.save(result.film);
  return result;
}

int render_loaded(const RenderCommand& command, const CommonFlags& common, Scene& scene,
                  RenderRun::Clock::time_point begin) {
  RenderRequest request = request_of(command, common, scene);
  check(request, command.scene);
  apply_flags(request, scene);
  RenderReport report{scene, request.options, command.given};
  report.tells_time = request.metadata_time;
  report.load_seconds = seconds_since(begin);
  RenderRun run(request, report, begin);
  if (!request.quiet) warn_of_darkening(request.display.tone), report.print_scene(request.verbose);

  try {
    report.result = run_limited(run, request, scene);
  } catch (const BandsInterrupted&) {
    fmt::print(stderr, "castray: interrupted; an image in bands is written whole or not at all\n");
    return 130;
  } catch (const PassesInterrupted&) {
    fmt::print(stderr, "castray: interrupted before the first sample; nothing was written\n");
    return 130;
  }
  report.total_seconds = seconds_since(begin);
  if (request.stats) write_file(*request.stats, report.json());
  report.print_nonfinite();
  if (!request.quiet) report.print_black();
  const Stopped stopped = report.result.stats.stopped;
  const bool as_asked = is_as_asked(request, stopped);
  if (!request.quiet) report.print_summary(request.outputs, as_asked);
  return as_asked ? 0 : stopped == Stopped::interrupted ? 130 : 1;
}

int render_scene(const RenderCommand& command, const CommonFlags& common) {
  const RenderRun::Clock::time_point begin = RenderRun::Clock::now();
  catch_snapshot_requests();
  Scene scene = load_told(command.scene, command.given, common);
  try {
    return render_loaded(command, common, scene, begin);
  } catch (const InputError& error) {
    throw placed_error(error, scene, [&](std::string_view flag) { return is_given(flag, command.given); });
  }
}

}  // namespace

Run add_render(Arguments& arguments, const CommonFlags& common) {
  auto command = std::make_shared<RenderCommand>();
  declare_flags(arguments, *command);
  arguments.footer(
      "Exit codes: 0 done; 1 stopped by --time-limit short of --spp or --target-error, or by --spp short of "
      "--target-error; 2 error; 130 interrupted (what was rendered is saved).");
  return [command, &common] { return render_scene(*command, common); };
}

}  // namespace castray::cli
