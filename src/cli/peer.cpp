#include "cli/peer.h"

#include <fmt/core.h>

#include <map>
#include <sstream>

#include "castray/error.h"
#include "cli/process.h"
#include "cli/shell_word.h"
#include "cli/temporary_folder.h"

namespace castray::cli {

namespace {

using Values = std::map<std::string, std::string>;

/// `command` with each {key} replaced; other braces, which shells use too, stay.
std::string filled_in(std::string command, const Values& values) {
  for (const auto& [key, value] : values) {
    const std::string place = "{" + key + "}";
    for (std::size_t at = command.find(place); at != std::string::npos;
         at = command.find(place, at + value.size()))
      command.replace(at, place.size(), value);
  }
  return command;
}

}  // namespace

Peer Peer::parse(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw InputError(fmt::format("--peer '{}': give it as NAME=COMMAND", text));
  const Peer peer{text.substr(0, equals), text.substr(equals + 1)};
  for (const char* place : {"{scene}", "{spp}", "{out}"})
    if (peer.command.find(place) == std::string::npos)
      throw InputError(fmt::format("--peer {}: its command has no {}; put it where the command takes it",
                                   peer.name, place));
  return peer;
}

double printed_seconds(const std::string& name, const std::string& output) {
  std::istringstream lines(output);
  std::string line;
  double seconds = -1;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string word;
    double value = 0;
    if (words >> word >> value && word == "seconds:") seconds = value;
  }
  if (!(seconds >= 0))
    throw InputError(
        fmt::format("peer {}: it printed no line 'seconds: X'; let it print its render time so", name));
  return seconds;
}

constexpr int no_equal_exit_code = 77;  // as test harnesses have it for a test that is not for this place

Contender peer_contender(const Peer& peer, const std::filesystem::path& scene, int width, int height,
                         int threads) {
  const auto render = [=](std::uint64_t spp, std::uint64_t seed) {
    const TemporaryFolder folder;
    const std::filesystem::path out = folder.path() / "image.pfm";
    const std::string command = filled_in(peer.command, {{"scene", shell_word(scene.string())},
                                                         {"spp", std::to_string(spp)},
                                                         {"seed", std::to_string(seed)},
                                                         {"out", shell_word(out.string())},
                                                         {"width", std::to_string(width)},
                                                         {"height", std::to_string(height)},
                                                         {"threads", std::to_string(threads)}});
    const ProcessResult result = run_command(command);
    if (result.exit_code == no_equal_exit_code)
      throw NoEqual(fmt::format("peer {}: {}", peer.name, result.last_error));
    if (result.exit_code != 0)
      throw InputError(
          fmt::format("peer {}: exit code {}: {}", peer.name, result.exit_code, result.last_error));
    if (!std::filesystem::exists(out))
      throw InputError(fmt::format("peer {}: it wrote no image to {{out}}", peer.name));
    return Rendering{read_image(out).image, printed_seconds(peer.name, result.output), result.seconds};
  };
  return {peer.name, ContenderKind::peer, peer.command, render};
}

}  // namespace castray::cli
