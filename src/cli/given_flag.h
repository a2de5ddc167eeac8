#pragma once

#include <string>

#include "cli/render_flags.h"

namespace castray::cli {

/// A flag as given on the command line.
struct GivenFlag {
  const RenderFlag* flag;
  std::string value;

  /// " --name value", the value as a word of a shell command.
  std::string text() const;
};

}  // namespace castray::cli
