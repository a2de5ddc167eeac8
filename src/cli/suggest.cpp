#include "cli/suggest.h"

#include <CLI/CLI.hpp>

#include "core/nearest.h"
#include "core/text.h"

namespace castray::cli {

namespace {

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

}  // namespace

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> used = app.get_subcommands();
  const CLI::App& at = used.empty() ? app : *used.front();
  for (const CLI::App* candidate : {&app, &at})
    for (const std::string& argument : candidate->remaining())
      if (argument != "--") return unknown(at, argument);
  if (used.empty() && dynamic_cast<const CLI::RequiredError*>(&error)) {
    std::string names;
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
      names += (names.empty() ? "" : ", ") + sub->get_name();
    return "say what to do: " + names + "; see castray --help";
  }
  return one_line(error.what());
}

}  // namespace castray::cli
