#pragma once

#include <functional>

#include "cli/arguments.h"
#include "cli/common_flags.h"

namespace castray::cli {

/// What a subcommand does once its flags are parsed; returns the exit code.
using Run = std::function<int()>;

// Each declares its flags and returns what runs it; `common` outlives that.
Run add_render(Arguments& arguments, const CommonFlags& common);
Run add_compare(Arguments& arguments, const CommonFlags& common);
Run add_accept(Arguments& arguments, const CommonFlags& common);
Run add_info(Arguments& arguments, const CommonFlags& common);
Run add_merge(Arguments& arguments, const CommonFlags& common);
Run add_serve(Arguments& arguments, const CommonFlags& common);
Run add_submit(Arguments& arguments, const CommonFlags& common);
Run add_convert(Arguments& arguments, const CommonFlags& common);
Run add_bench(Arguments& arguments, const CommonFlags& common);
Run add_denoise(Arguments& arguments, const CommonFlags& common);
Run add_completions(Arguments& arguments, const CommonFlags& common);

}  // namespace castray::cli
