#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace castray::cli {

/// What a subcommand does once its flags are parsed; returns the exit code.
using Run = std::function<int()>;

// Each declares its flags on `app` and returns what runs it.
Run add_render(CLI::App& app);
Run add_compare(CLI::App& app);
Run add_accept(CLI::App& app);
Run add_info(CLI::App& app);
Run add_merge(CLI::App& app);
Run add_convert(CLI::App& app);
Run add_bench(CLI::App& app);

}  // namespace castray::cli
