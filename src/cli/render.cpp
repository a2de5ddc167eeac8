#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "castray/error.h"
#include "cli/commands.h"
#include "cli/display_flags.h"
#include "cli/interrupt.h"
#include "cli/render_flags.h"
#include "cli/render_report.h"
#include "cli/render_run.h"
#include "core/files.h"

namespace castray::cli {

namespace {

namespace fs = std::filesystem;
double seconds_since(RenderRun::Clock::time_point begin) {
  return std::chrono::duration<double>(RenderRun::Clock::now() - begin).count();
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
  const bool spp_limits = is_given(command, "spp") || request.options.samples;
  if (request.options.target_error && !spp_limits) request.options.spp = most_samples_to_target;
  request.until_time_limit = request.options.time_limit && !request.options.target_error && !spp_limits;
  if (request.until_time_limit) request.options.spp = most_samples;
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
  if (request.replicates && (request.checkpoint || request.preview_seconds || request.options.time_limit ||
                             request.options.target_error))
    throw InputError(
        "--replicates: cannot go with --checkpoint, --preview-every, --time-limit or --target-error; leave "
        "one "
        "out");
  if (request.checkpoint && request.options.target_error)
    throw InputError("--target-error: cannot go with --checkpoint; leave one out");
  for (const fs::path& output : request.outputs) check_output_image(output);
  std::vector<fs::path> all = request.outputs;
  if (request.stats) all.push_back(*request.stats);
  check_one_standard_output(all);
  if (request.stats) check_writable(*request.stats);
}

/// Whether the render came to the end that was asked for.
bool is_as_asked(const RenderRequest& request, Stopped stopped) {
  if (request.options.target_error) return stopped == Stopped::target_error;
  return stopped == Stopped::done || (stopped == Stopped::time_limit && request.until_time_limit);
}

int render_scene(const RenderCommand& command, const CommonFlags& common) {
  const RenderRun::Clock::time_point begin = RenderRun::Clock::now();
  catch_snapshot_requests();
  Scene scene = load_scene(command.scene);
  RenderRequest request = request_of(command, common, scene);
  check(request);
  apply_flags(request, scene);
  RenderReport report{scene, request.options, command.given};
  report.tells_time = request.metadata_time;
  report.load_seconds = seconds_since(begin);
  RenderRun run(request, report, begin);
  if (!request.quiet) warn_of_darkening(request.display.tone), report.print_scene(request.verbose);

  report.result = run.run(scene);
  run.save(report.result.film);
  report.total_seconds = seconds_since(begin);
  if (request.stats) write_file(*request.stats, report.json());
  report.print_nonfinite();
  if (!request.quiet) report.print_black();
  const Stopped stopped = report.result.stats.stopped;
  const bool as_asked = is_as_asked(request, stopped);
  if (!request.quiet) report.print_summary(request.outputs, as_asked);
  return as_asked ? 0 : stopped == Stopped::interrupted ? 130 : 1;
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
