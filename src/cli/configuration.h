#pragma once

#include <filesystem>
#include <string>

#include "bench/measure.h"
#include "castray/render.h"
#include "cli/render_flags.h"

namespace castray::cli {

/// "NAME=FLAGS": castray under a name, with rendering flags.
struct Configuration {
  std::string name, flags;
};
Configuration split_configuration(const std::string& text);

/// The request of the scene's "render" section and then of `flags`, a text as on the command line. Throws
/// InputError as `castray render` would, and for flags that a benchmark decides itself.
RenderRequest configured_request(const Scene& scene, const std::string& flags);

/// "WxH", as --size takes it.
void parse_size(const std::string& text, int& width, int& height);

/// Where a configuration renders.
struct ConfiguredRender {
  const Scene& scene;
  int width = 0, height = 0, threads = 0;  ///< threads 0: those of the flags
};

/// Renders by the library; with seed 1, unless it is an ablation, also as a process of its own, to time the
/// whole.
Contender configuration_contender(const ConfiguredRender& where, const Configuration& configuration,
                                  ContenderKind kind);

}  // namespace castray::cli
