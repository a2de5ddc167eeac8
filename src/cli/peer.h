#pragma once

#include <filesystem>
#include <string>

#include "bench/measure.h"

namespace castray::cli {

/// "NAME=COMMAND" of --peer. Throws InputError unless both are there, and {scene}, {spp} and {out} in the
/// command.
struct Peer {
  std::string name, command;

  static Peer parse(const std::string& text);
};

/// Renders by the peer's command: {scene}, {spp}, {seed}, {out}, {width}, {height} and {threads} are filled
/// in; the command writes linear radiance to {out}, a .pfm, and prints "seconds: X", the time of the render
/// alone. With exit code 77 it says that the scene has something it has no equal of.
Contender peer_contender(const Peer& peer, const std::filesystem::path& scene, int width, int height,
                         int threads);

/// X of the last line "seconds: X" of a program's output. Throws InputError if there is none.
double printed_seconds(const std::string& name, const std::string& output);

}  // namespace castray::cli
