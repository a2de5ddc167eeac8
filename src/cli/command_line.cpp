#include "cli/command_line.h"

#include <algorithm>
#include <charconv>
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "castray/error.h"
#include "cli/argument_forms.h"
#include "cli/command_help.h"
#include "core/nearest.h"
#include "core/text.h"

namespace castray::cli {

namespace {

struct Subcommand {
  const char* name;
  const char* description;
  Run (*add)(Arguments&, const CommonFlags&);
};

constexpr Subcommand subcommands[] = {
    // in the order of use
    {"render", "render a scene to an image", add_render},
    {"serve", "show a scene on a local page: it converges, turns, is exposed and saved", add_serve},
    {"compare", "measure how an image differs from its reference", add_compare},
    {"accept", "make an image the reference", add_accept},
    {"bench", "time against error, of castray and of other renderers", add_bench},
    {"info", "what a scene holds, what it needs, warnings", add_info},
    {"merge", "add films of one render: parts, sample ranges, crops", add_merge},
    {"submit", "render in parts on many machines, and merge them", add_submit},
    {"convert", "write an image in another format, or a scene as a scene file", add_convert},
    {"denoise", "less noise by Open Image Denoise, with bias", add_denoise},
    {"completions", "print what makes a shell complete castray's flags, or the manual page", add_completions},
};

/// The app of all commands; parsing sets `chosen`.
std::shared_ptr<CLI::App> make_app(Run& chosen) {
  const auto app =
      std::make_shared<CLI::App>("castray renders triangle scenes by path tracing on the CPU.", "castray");
  app->set_version_flag("--version", "castray " CASTRAY_VERSION);
  app->footer("'castray help COMMAND' lists the flags of a command.");
  app->require_subcommand(1);
  for (const Subcommand& subcommand : subcommands) {
    CLI::App* sub = app->add_subcommand(subcommand.name, subcommand.description);
    Arguments arguments(*sub);
    const auto common = std::make_shared<CommonFlags>();
    const Run run = subcommand.add(arguments, *common);
    common->add_to(arguments);
    sub->callback([run, common, &chosen] { chosen = [run, common] { return run(); }; });
  }
  return app;
}

FlagHelp help_of(const CLI::Option& option) {
  FlagHelp flag;
  for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
  if (flag.names.empty()) flag.names.push_back(option.get_name());
  if (option.get_items_expected_max() > 0) flag.metavar = option.get_type_name();
  flag.help = option.get_description();
  flag.group = option.get_group();
  flag.repeatable = option.get_items_expected_max() > 1;
  return flag;
}

std::string unknown(const CLI::App& app, const std::string& argument) {
  std::vector<std::string> names;
  std::string kind = "flag";
  if (argument.starts_with("-")) {
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
  } else {
    kind = "argument";
    if (!app.get_parent()) kind = "subcommand";
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(sub->get_name());
  }
  const std::string word = argument.substr(0, argument.find('='));
  const std::string help = "see castray" + (app.get_parent() ? " " + app.get_name() : "") + " --help";
  const std::string_view near = nearest(word, {names.begin(), names.end()});
  return "unknown " + kind + " '" + printable(word) + "'; " +
         (near.empty() ? help : "did you mean '" + std::string(near) + "'?");
}

std::string one_line(std::string text) {
  for (std::size_t at; (at = text.find('\n')) != std::string::npos;) text.replace(at, 1, " ");
  return text;
}

/// The name that CLI11's message begins with, and what stands for its value in the help.
struct NamedOption {
  std::string name;
  const CLI::Option* option;

  NamedOption(const CLI::App& app, std::string_view message, std::string_view end)
      : name(message.substr(0, message.find(end))), option(app.get_option_no_throw(name)) {}
  std::string value() const { return option ? option->get_type_name() : ""; }
  bool is_switch() const { return option && option->get_items_expected_max() == 0; }
};

std::string explain_missing(const CLI::App& app, const std::string& message) {
  const NamedOption missing(app, message, " is required");
  return missing.name + (missing.value().empty() ? "" : " " + missing.value()) + " is missing; see castray " +
         app.get_name() + " --help";
}

std::string explain_no_value(const CLI::App& app, const std::string& message) {
  const NamedOption flag(app, message, ":");
  return flag.name + ": needs a value, " + flag.value();
}

/// Of "Could not convert: --name = text".
std::string explain_conversion(const CLI::App& app, std::string_view message) {
  constexpr std::string_view before = "Could not convert: ", between = " = ";
  if (message.starts_with(before)) message.remove_prefix(before.size());
  const std::size_t equals = message.find(between);
  if (equals == message.npos) return one_line(std::string(message));
  const NamedOption flag(app, message, between);
  const std::string text(message.substr(equals + between.size()));
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return flag.name + " '" + printable(text) + "': must be " +
         (flag.is_switch() ? "on or off, or left out"
          : is_number      ? "a whole number"
                           : "a number");
}

/// The name of the first word that is not known.
std::optional<std::string> explain_unknown(const CLI::App& app, const CLI::App& at) {
  for (const CLI::App* candidate : {&app, &at})
    for (const std::string& argument : candidate->remaining())
      if (argument != "--") return unknown(at, argument);
  return std::nullopt;
}

std::string what_to_do(const CLI::App& app) {
  std::string names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names += (names.empty() ? "" : ", ") + sub->get_name();
  return "say what to do: " + names + "; see castray --help";
}

/// One line that says what is wrong with the command line; an unknown flag or subcommand comes with the
/// nearest known one.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> used = app.get_subcommands();
  const CLI::App& at = used.empty() ? app : *used.front();
  if (const auto text = explain_unknown(app, at)) return *text;
  if (dynamic_cast<const CLI::RequiredError*>(&error))
    return used.empty() ? what_to_do(app) : explain_missing(at, error.what());
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return explain_no_value(at, error.what());
  if (dynamic_cast<const CLI::ConversionError*>(&error)) return explain_conversion(at, error.what());
  return one_line(error.what());
}

}  // namespace

Run parse_command_line(int argc, const char* const* argv) {
  Run chosen;
  const auto app = make_app(chosen);
  try {
    std::vector<std::string> words = plain_arguments({argv + std::min(argc, 1), argv + argc});
    std::reverse(words.begin(), words.end());  // as CLI11 wants them
    app->parse(std::move(words));
  } catch (const CLI::Success& help) {
    if (const auto text = explain_unknown(*app, *app)) throw InputError(*text);
    return [app, help] { return app->exit(help); };
  } catch (const CLI::ParseError& error) {
    throw InputError(explain(*app, error));
  }
  return [app, chosen] { return chosen(); };
}

std::vector<CommandHelp> command_helps() {
  Run unused;
  const auto app = make_app(unused);
  std::vector<CommandHelp> commands;
  for (const CLI::App* sub : app->get_subcommands([](const CLI::App*) { return true; })) {
    commands.push_back({sub->get_name(), sub->get_description(), sub->get_footer(), {}});
    for (const CLI::Option* option : sub->get_options())
      if (option != sub->get_help_ptr() && !option->get_group().empty())
        commands.back().flags.push_back(help_of(*option));
  }
  return commands;
}

}  // namespace castray::cli
