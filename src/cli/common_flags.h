#pragma once

#include "cli/arguments.h"

namespace castray::cli {

/// Flags that every command takes.
struct CommonFlags {
  bool quiet = false;    ///< no progress and no warnings
  bool verbose = false;  ///< where a command has more to say, it does
  int threads = 0;       ///< at most so many; 0: as many as the process may keep busy

  void add_to(Arguments& arguments);
};

}  // namespace castray::cli
