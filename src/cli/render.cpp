#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "castray/error.h"
#include "castray/film.h"
#include "cli/commands.h"
#include "cli/display_flags.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/render_flags.h"
#include "cli/render_report.h"
#include "core/files.h"

namespace castray::cli {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// What the command line says, as text: values are read after the scene's own defaults.
struct RenderCommand {
  std::string scene;
  std::vector<std::string> outputs;
  std::vector<GivenFlag> given;
};

void declare_flags(Arguments& arguments, RenderCommand& command) {
  arguments.add_positional("SCENE", command.scene, "scene .json, or .obj; - is a scene on the standard input")
      .required();
  for (const RenderFlag& flag : render_flags())
    arguments
        .add_text((flag.letter ? std::string{'-', flag.letter, ','} : "") + "--" + flag.name, flag.metavar,
                  flag.help,
                  [&command, &flag](const std::string& value) {
                    command.given.push_back({&flag, value});
                  })
        .group(flag.group);
  arguments
      .add("-o,--output", command.outputs, "FILE",
           "image or film, repeatable; .ppm .png .pfm .hdr .exr .film [SCENE.png here]")
      .group("Output");
}

bool is_given(const RenderCommand& command, std::string_view flag) {
  return std::any_of(command.given.begin(), command.given.end(),
                     [&](const GivenFlag& given) { return given.flag->name == flag; });
}

RenderRequest request_of(const RenderCommand& command, const CommonFlags& common, const Scene& scene) {
  RenderRequest request;
  apply_defaults(request, scene);
  for (const GivenFlag& given : command.given) given.flag->set(request, given.flag->name, given.value);
  if (request.options.target_error && !is_given(command, "spp")) request.options.spp = most_samples_to_target;
  request.outputs.assign(command.outputs.begin(), command.outputs.end());
  if (request.outputs.empty()) request.outputs.push_back(scene.name + ".png");
  request.quiet = common.quiet;
  request.verbose = common.verbose;
  return request;
}

/// All that could spoil the result is found before the work starts.
void check(const RenderRequest& request) {
  if (request.resume && !request.checkpoint)
    throw InputError("--resume: needs --checkpoint FILE to resume from");
  if (request.replicates &&
      (request.checkpoint || request.options.time_limit || request.options.target_error))
    throw InputError(
        "--replicates: cannot go with --checkpoint, --time-limit or --target-error; leave one out");
  if (request.checkpoint && request.options.target_error)
    throw InputError("--target-error: cannot go with --checkpoint; leave one out");
  for (const fs::path& output : request.outputs) check_output_image(output);
  std::vector<fs::path> all = request.outputs;
  if (request.stats) all.push_back(*request.stats);
  check_one_standard_output(all);
  if (request.checkpoint && !is_film_format(*request.checkpoint))
    throw InputError(request.checkpoint->string() + ": a checkpoint's name must end in .film");
  if (request.checkpoint) check_output_image(*request.checkpoint);
  if (request.stats) check_writable(*request.stats);
}

std::unique_ptr<Film> film_to_resume(const RenderRequest& request) {
  if (!request.resume || !fs::exists(*request.checkpoint)) return nullptr;
  return std::make_unique<Film>(read_film(*request.checkpoint));
}

/// Renders with progress, checkpoints and clean interruption.
RenderResult render_watched(const Scene& scene, const RenderRequest& request) {
  catch_interrupts();
  const std::unique_ptr<Film> start = film_to_resume(request);
  ProgressDisplay display(request.quiet ? ProgressMode::off : request.progress);
  Clock::time_point saved = Clock::now();
  const ProgressCallback watch = [&](const Progress& progress) {
    display.update(progress);
    if (request.checkpoint && progress.film && seconds_since(saved) >= request.checkpoint_seconds) {
      write_film(*request.checkpoint, *progress.film);
      saved = Clock::now();
    }
    return !interrupted();
  };
  const PreparedScene prepared = prepare(scene, request);
  RenderResult result = request.replicates
                            ? render_replicates(prepared, request.options, request.replicates, watch)
                            : render(prepared, request.options, watch, start.get());
  display.finish();
  return result;
}

void write_results(const RenderRequest& request, const RenderReport& report) {
  const Film& film = report.result.film;
  for (const fs::path& output : request.outputs) write_film(output, film, request.display, report.metadata());
  if (request.checkpoint) write_film(*request.checkpoint, film);
  if (request.stats) write_file(*request.stats, report.json());
}

int exit_code(const RenderRequest& request, Stopped stopped) {
  if (stopped == Stopped::interrupted) return 130;
  const bool as_asked = stopped == (request.options.target_error ? Stopped::target_error : Stopped::done);
  return as_asked ? 0 : 1;
}

int render_scene(const RenderCommand& command, const CommonFlags& common) {
  const Clock::time_point begin = Clock::now();
  Scene scene = load_scene(command.scene);
  RenderRequest request = request_of(command, common, scene);
  check(request);
  apply_flags(request, scene);
  RenderReport report{scene, request.options, command.given};
  report.tells_time = request.metadata_time;
  report.load_seconds = seconds_since(begin);
  if (!request.quiet) warn_of_darkening(request.display.tone), report.print_scene(request.verbose);

  report.result = render_watched(scene, request);
  report.total_seconds = seconds_since(begin);
  write_results(request, report);
  report.total_seconds = seconds_since(begin);
  report.print_nonfinite();
  if (!request.quiet) report.print_black();
  if (!request.quiet) report.print_summary(request.outputs);
  return exit_code(request, report.result.stats.stopped);
}

}  // namespace

Run add_render(Arguments& arguments, const CommonFlags& common) {
  auto command = std::make_shared<RenderCommand>();
  declare_flags(arguments, *command);
  arguments.footer(
      "Exit codes: 0 done; 1 stopped by --time-limit or, short of --target-error, by --spp; 2 error; 130 "
      "interrupted (what was rendered is saved).");
  return [command, &common] { return render_scene(*command, common); };
}

}  // namespace castray::cli
