#include "cli/command_line.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "castray/error.h"
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
    {"accept", "make an image the reference", add_accept},
    {"bench", "time against error, of castray and of other renderers", add_bench},
    {"info", "what a scene holds, what it needs, warnings", add_info},
    {"merge", "add films of disjoint sample ranges", add_merge},
    {"convert", "write an image in another format", add_convert},
};

}  // namespace

Run parse_command_line(int argc, const char* const* argv) {
  const auto app =
      std::make_shared<CLI::App>("castray renders triangle scenes by path tracing on the CPU.", "castray");
  app->set_version_flag("--version", "castray " CASTRAY_VERSION);
  app->require_subcommand(1);
  Run chosen;
  for (const Subcommand& subcommand : subcommands) {
    CLI::App* sub = app->add_subcommand(subcommand.name, subcommand.description);
    sub->callback([run = subcommand.add(*sub), &chosen] { chosen = run; });
  }
  try {
    app->parse(argc, argv);
  } catch (const CLI::Success& help) {
    return [app, help] { return app->exit(help); };
  } catch (const CLI::ParseError& error) {
    throw InputError(explain(*app, error));
  }
  return [app, chosen] { return chosen(); };
}

}  // namespace castray::cli
