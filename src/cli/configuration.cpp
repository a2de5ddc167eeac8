#include "cli/configuration.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <sstream>

#include "castray/error.h"
#include "cli/process.h"
#include "cli/shell_word.h"
#include "cli/temporary_folder.h"
#include "core/nearest.h"

namespace castray::cli {

namespace {

/// Flags that say what is rendered, not how: a benchmark decides them.
bool decided_here(const RenderFlag& flag) {
  static constexpr std::string_view names[] = {"spp", "seed", "size"};
  return !flag.in_scene || std::find(std::begin(names), std::end(names), flag.name) != std::end(names);
}

const RenderFlag& find_flag(const std::string& word) {
  std::vector<std::string_view> names;
  for (const RenderFlag& flag : render_flags()) {
    if (decided_here(flag)) continue;
    if (word == std::string("--") + flag.name) return flag;
    names.push_back(flag.name);
  }
  const std::string_view name = std::string_view(word).substr(std::min<std::size_t>(2, word.size()));
  throw InputError(fmt::format("'{}' is no flag of a configuration{}", word, suggestion(name, names)));
}

/// The wall time of `castray render` with the same flags, from start to end.
double whole_process_seconds(const ConfiguredRender& where, const std::string& flags, std::uint64_t spp,
                             std::uint64_t seed) {
  const TemporaryFolder folder;
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  std::string command =
      fmt::format("{} render {} {} --spp {} --seed {} --size {}x{} -q -o {}", shell_word(program),
                  shell_word(where.scene.file.string()), flags, spp, seed, where.width, where.height,
                  shell_word((folder.path() / "image.pfm").string()));
  if (where.threads > 0) command += fmt::format(" --threads {}", where.threads);
  const ProcessResult result = run_command(command);
  if (result.exit_code != 0)
    throw InputError(fmt::format("exit code {} of {}: {}", result.exit_code, command, result.last_error));
  return result.seconds;
}

}  // namespace

Configuration split_configuration(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(fmt::format("--config '{}': give it as NAME=FLAGS", text));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

RenderRequest configured_request(const Scene& scene, const std::string& flags) {
  RenderRequest request;
  apply_defaults(request, scene);
  std::istringstream words(flags);
  for (std::string word; words >> word;) {
    const RenderFlag& flag = find_flag(word);
    std::string value = "on";
    if (flag.metavar && !(words >> value)) throw InputError(fmt::format("--{} needs a value", flag.name));
    flag.set(request, flag.name, value);
  }
  return request;
}

void parse_size(const std::string& text, int& width, int& height) {
  const auto flags = render_flags();
  RenderRequest request;
  std::find_if(flags.begin(), flags.end(), [](const RenderFlag& flag) {
    return flag.name == std::string_view("size");
  })->set(request, "size", text);
  width = request.options.width;
  height = request.options.height;
}

Contender configuration_contender(const ConfiguredRender& where, const Configuration& configuration,
                                  ContenderKind kind) {
  RenderRequest request = configured_request(where.scene, configuration.flags);
  request.options.width = where.width;
  request.options.height = where.height;
  if (where.threads > 0) request.options.threads = where.threads;
  const auto prepared = std::make_shared<std::optional<PreparedScene>>();  // by the first render
  const auto render_one = [=](std::uint64_t spp, std::uint64_t seed) {
    RenderOptions now = request.options;
    now.spp = spp;
    now.seed = seed;
    if (!*prepared) *prepared = prepare(where.scene, request);
    const RenderResult result = render(**prepared, now);
    const auto begin = std::chrono::steady_clock::now();
    Image image = image_of(result.film, now.threads);
    const std::chrono::duration<double> reconstruction = std::chrono::steady_clock::now() - begin;
    return Rendering{std::move(image), result.stats.render_seconds + reconstruction.count(), {}};
  };
  const auto process_seconds = [=, flags = configuration.flags](std::uint64_t spp, std::uint64_t seed) {
    return whole_process_seconds(where, flags, spp, seed);
  };
  Contender contender{configuration.name, kind, configuration.flags, render_one, {}};
  if (kind == ContenderKind::configuration) contender.process_seconds = process_seconds;
  return contender;
}

}  // namespace castray::cli
