#pragma once

#include <functional>

#include "cli/arguments.h"

namespace castray::cli {

/// What a subcommand does once its flags are parsed; returns the exit code.
using Run = std::function<int()>;

// Each declares its flags and returns what runs it.
Run add_render(Arguments& arguments);
Run add_compare(Arguments& arguments);
Run add_accept(Arguments& arguments);
Run add_info(Arguments& arguments);
Run add_merge(Arguments& arguments);
Run add_convert(Arguments& arguments);
Run add_bench(Arguments& arguments);
Run add_completions(Arguments& arguments);

}  // namespace castray::cli
