#pragma once

#include "cli/commands.h"

namespace castray::cli {

/// What the words of a command line ask for; nothing is done before it is called. Throws InputError where
/// they make no sense.
Run parse_command_line(int argc, const char* const* argv);

}  // namespace castray::cli
