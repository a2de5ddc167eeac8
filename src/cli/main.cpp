#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "castray/error.h"
#include "cli/commands.h"

namespace castray::cli {

namespace {

struct Subcommand {
  const char* name;
  const char* description;
  Run (*add)(CLI::App&);
};

constexpr Subcommand subcommands[] = {
    // one line each, in alphabetical order of use: render, compare, bench, info, merge, convert
    {nullptr, nullptr, nullptr},
};

int run(int argc, char** argv) {
  CLI::App app{"castray renders triangle scenes by path tracing on the CPU.", "castray"};
  app.set_version_flag("--version", "castray " CASTRAY_VERSION);
  app.require_subcommand(1);
  int exit_code = 0;
  for (const Subcommand& subcommand : subcommands) {
    if (!subcommand.name) continue;
    CLI::App* sub = app.add_subcommand(subcommand.name, subcommand.description);
    Run run = subcommand.add(*sub);
    sub->callback([run, &exit_code] { exit_code = run(); });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    throw InputError(error.what());
  }
  return exit_code;
}

}  // namespace

}  // namespace castray::cli

int main(int argc, char** argv) {
  try {
    return castray::cli::run(argc, argv);
  } catch (const castray::InputError& error) {
    fmt::print(stderr, "castray: error: {}\n", error.what());
    return 2;
  }
}
