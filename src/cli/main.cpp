#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <new>

#include "castray/error.h"
#include "cli/commands.h"
#include "cli/suggest.h"

namespace castray::cli {

namespace {

struct Subcommand {
  const char* name;
  const char* description;
  Run (*add)(CLI::App&);
};

constexpr Subcommand subcommands[] = {
    // in the order of use: render, compare, bench, info, merge, convert
    {"render", "render a scene to an image", add_render},
    {"compare", "measure how an image differs from its reference", add_compare},
    {"bench", "time against error, of castray and of other renderers", add_bench},
    {"info", "what a scene holds, what it needs, warnings", add_info},
    {"merge", "add films of disjoint sample ranges", add_merge},
    {"convert", "write an image in another format", add_convert},
};

int run(int argc, char** argv) {
  CLI::App app{"castray renders triangle scenes by path tracing on the CPU.", "castray"};
  app.set_version_flag("--version", "castray " CASTRAY_VERSION);
  app.require_subcommand(1);
  int exit_code = 0;
  for (const Subcommand& subcommand : subcommands) {
    CLI::App* sub = app.add_subcommand(subcommand.name, subcommand.description);
    Run run = subcommand.add(*sub);
    sub->callback([run, &exit_code] { exit_code = run(); });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    throw InputError(explain(app, error));
  }
  return exit_code;
}

}  // namespace

}  // namespace castray::cli

int main(int argc, char** argv) {
  const auto fail = [](const char* message) {
    fmt::print(stderr, "castray: error: {}\n", message);
    return 2;
  };
  try {
    return castray::cli::run(argc, argv);
  } catch (const std::bad_alloc&) {
    return fail("out of memory; a smaller image or scene is needed");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
