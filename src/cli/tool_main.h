#pragma once

#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "castray/error.h"

namespace castray {

/// The main function of a small tool: reads the command line, then works. Returns the exit code: what `work`
/// returns; 0 after --help; 2, with one line on stderr, for a wrong command line or an InputError.
template <class Work>
int tool_main(CLI::App& app, int argc, char** argv, Work work) {
  const auto fail = [&](const std::exception& error) {
    fmt::print(stderr, "{}: error: {}\n", app.get_name(), error.what());
    return 2;
  };
  try {
    app.parse(argc, argv);
    return work();
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return fail(error);
  } catch (const InputError& error) {
    return fail(error);
  }
}

}  // namespace castray
