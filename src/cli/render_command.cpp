#include "cli/render_command.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include "castray/error.h"
#include "cli/display_flags.h"
#include "cli/phase.h"
#include "cli/render_passes.h"
#include "cli/shell_word.h"
#include "core/files.h"

namespace castray::cli {

namespace fs = std::filesystem;

void declare_flag(Arguments& arguments, const RenderFlag& flag, std::vector<GivenFlag>& given) {
  arguments
      .add_text((flag.letter ? std::string{'-', flag.letter, ','} : "") + "--" + flag.name, flag.metavar,
                flag.help,
                [&given, &flag](const std::string& value) {
                  given.push_back({&flag, value});
                })
      .group(flag.group);
}

void declare_flags(Arguments& arguments, RenderCommand& command) {
  arguments
      .add_positional("SCENE", command.scene,
                      "scene .json, .gltf, .glb, .obj or .ply; - is a scene on the standard input")
      .required();
  for (const RenderFlag& flag : render_flags()) declare_flag(arguments, flag, command.given);
  arguments
      .add("-o,--output", command.outputs, "FILE",
           "image or film, repeatable; .ppm .png .pfm .hdr .exr .film [SCENE.png here]")
      .group("Output");
}

Scene load_told(const std::string& file, const std::vector<GivenFlag>& given, const CommonFlags& common) {
  RenderRequest request;
  for (const GivenFlag& flag : given)
    if (flag.flag->name == std::string_view("progress")) flag.flag->set(request, flag.flag->name, flag.value);
  const Phase phase(common.quiet ? ProgressMode::off : request.progress, "reading " + file);
  return load_scene(file);
}

bool is_given(std::string_view flag, const std::vector<GivenFlag>& given) {
  return std::any_of(given.begin(), given.end(),
                     [&](const GivenFlag& one) { return one.flag->name == flag; });
}

namespace {

/// The samples of the part, and its number in the names of files.
void take_part(RenderRequest& request) {
  RenderOptions& options = request.options;
  if (options.target_error)
    throw InputError("--part: cannot go with --target-error, which decides the samples; leave one out");
  const SampleRange all = options.samples.value_or(
      SampleRange{0, request.replicates ? options.spp / request.replicates : options.spp});
  options.samples = range_of(*request.part, all);
  if (!options.time_limit && !request.replicates) options.planned = all;
  const auto rename = [&](std::filesystem::path& file) { file = name_of(*request.part, file); };
  std::for_each(request.outputs.begin(), request.outputs.end(), rename);
  if (request.checkpoint) rename(*request.checkpoint);
  if (request.stats) rename(*request.stats);
}

}  // namespace

RenderRequest request_of(const RenderCommand& command, const CommonFlags& common, const Scene& scene) {
  RenderRequest request;
  apply_defaults(request, scene);
  for (const GivenFlag& given : command.given) given.flag->set(request, given.flag->name, given.value);
  const bool spp_limits = is_given("spp", command.given) || request.options.samples;
  if (request.options.target_error && !spp_limits) request.options.spp = most_samples_to_target;
  request.until_time_limit = request.options.time_limit && !request.options.target_error && !spp_limits;
  if (request.until_time_limit) request.options.spp = most_samples;
  request.outputs.assign(command.outputs.begin(), command.outputs.end());
  if (request.outputs.empty()) request.outputs.push_back(scene.name + ".png");
  if (request.part) take_part(request);
  request.quiet = common.quiet;
  request.verbose = common.verbose;
  return request;
}

InputError placed_error(const InputError& error, const Scene& scene,
                        const std::function<bool(std::string_view)>& is_given) {
  const std::string_view text = error.what();
  for (const RenderDefault& given : scene.render_defaults) {
    const std::string flag = "--" + given.name;
    const bool is_of_flag = text.starts_with(flag) && text.substr(flag.size()).find_first_of(" :") == 0;
    if (is_of_flag && !is_given(given.name)) return {given.place, std::string(text)};
  }
  return error;
}

/// All that could spoil the result is found before the work starts.
void check(const RenderRequest& request, const fs::path& scene) {
  if (request.resume && !request.checkpoint)
    throw InputError("--resume: needs --checkpoint FILE to resume from");
  if (request.replicates && (request.checkpoint || request.preview_seconds || request.options.time_limit ||
                             request.options.target_error))
    throw InputError(
        "--replicates: cannot go with --checkpoint, --preview-every, --time-limit or --target-error; leave "
        "one out");
  if (request.checkpoint && request.options.target_error)
    throw InputError("--target-error: cannot go with --checkpoint; leave one out");
  for (const fs::path& output : request.outputs) check_output_image(output);
  check_passes(request);
  std::vector<fs::path> all = request.outputs;
  for (const std::optional<fs::path>& file : {request.stats, request.checkpoint})
    if (file) all.push_back(*file);
  check_distinct(all);
  std::error_code ignored;
  for (const fs::path& file : all)
    if (fs::equivalent(file, scene, ignored))
      throw InputError({file.string()}, "is the scene itself; give another name");
  if (request.stats) check_writable(*request.stats);
}

std::string GivenFlag::text() const {
  const std::string name = std::string(" --") + flag->name;
  return flag->metavar ? name + " " + shell_word(value) : name;
}

}  // namespace castray::cli
