#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "cli/command_help.h"
#include "cli/commands.h"
#include "cli/values.h"

namespace castray::cli {

namespace {

/// `text` with a backslash before each of `special`.
std::string escaped(const std::string& text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// In single quotes, as sh and zsh read them.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_names(const std::vector<CommandHelp>& commands) {
  std::vector<std::string> names;
  for (const CommandHelp& command : commands) names.push_back(command.name);
  return fmt::format("{}", fmt::join(names, " "));
}

/// What zsh offers for the value of a flag.
std::string zsh_action(const FlagHelp& flag) {
  const auto choices = flag.choices();
  if (!choices.empty()) return fmt::format("({})", fmt::join(choices, " "));
  if (flag.takes_file()) return "_files";
  return flag.metavar == "FOLDER" ? "_files -/" : "";
}

std::string zsh_flag(const FlagHelp& flag) {
  const std::string help = escaped(flag.help, "[]:\\");
  const std::string action = ":" + escaped(flag.metavar, ":") + ":" + zsh_action(flag);
  if (flag.positional()) return quoted((flag.repeatable ? "*" : "") + std::string(":") + help + ":_files");
  std::string text;
  for (const std::string& name : flag.names)
    text += (text.empty() ? "" : " ") + quoted((flag.repeatable ? "*" : "") + name + "[" + help + "]" +
                                               (flag.metavar.empty() ? "" : action));
  return text;
}

std::string fish_flag(const std::string& command, const FlagHelp& flag) {
  std::string text = fmt::format("complete -c castray -n '__fish_seen_subcommand_from {}'", command);
  for (const std::string& name : flag.names)
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  const auto choices = flag.choices();
  if (!choices.empty())
    text += fmt::format(" -x -a '{}'", fmt::join(choices, " "));
  else if (flag.metavar == "FOLDER")
    text += " -x -a '(__fish_complete_directories)'";
  else if (!flag.metavar.empty())
    text += flag.takes_file() ? " -r -F" : " -x";
  return text + " -d '" + escaped(flag.help, "'\\") + "'\n";
}

}  // namespace

std::vector<std::string> FlagHelp::choices() const {
  std::vector<std::string> found;
  if (metavar.find('|') == std::string::npos) return found;
  for (const std::string& word : split(metavar, '|'))
    if (std::all_of(word.begin(), word.end(),
                    [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; }))
      found.push_back(word);
  return found;
}

std::string bash_completion(const std::vector<CommandHelp>& commands) {
  std::string values, flags;
  for (const CommandHelp& command : commands) {
    flags += "      " + command.name + ") words='--help";
    for (const FlagHelp& flag : command.flags) {
      if (flag.positional()) continue;
      flags += " " + fmt::format("{}", fmt::join(flag.names, " "));
      if (flag.metavar.empty() || flag.takes_file()) continue;
      const auto choices = flag.choices();
      for (const std::string& name : flag.names)
        values +=
            fmt::format("      '{} {}') {} ;;\n", command.name, name,
                        choices.empty() ? "return" : fmt::format("words='{}'", fmt::join(choices, " ")));
    }
    flags += "' ;;\n";
  }
  return R"(# bash completion for castray
_castray() {
  local word=${COMP_WORDS[COMP_CWORD]} words=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    words=')" +
         command_names(commands) + R"( --help --version'
  else
    case "${COMP_WORDS[1]} ${COMP_WORDS[COMP_CWORD - 1]}" in
)" + values +
         R"(    esac
    [ -n "$words" ] || [[ $word != -* ]] || case "${COMP_WORDS[1]}" in
)" + flags +
         R"(    esac
  fi
  if [ -n "$words" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -o filenames -F _castray castray
)";
}

std::string zsh_completion(const std::vector<CommandHelp>& commands) {
  std::string descriptions, cases;
  for (const CommandHelp& command : commands) {
    descriptions += "    " + quoted(command.name + ":" + escaped(command.description, ":\\")) + "\n";
    cases += "    " + command.name + ") _arguments -S";
    for (const FlagHelp& flag : command.flags) cases += " \\\n      " + zsh_flag(flag);
    cases += " ;;\n";
  }
  return R"(#compdef castray
_castray() {
  local -a commands=(
)" + descriptions +
         R"(  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
)" + cases +
         R"(  esac
}
_castray "$@"
)";
}

std::string fish_completion(const std::vector<CommandHelp>& commands) {
  std::string script = "# fish completion for castray\n";
  for (const CommandHelp& command : commands)
    script += fmt::format("complete -c castray -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                          escaped(command.description, "'\\"));
  for (const CommandHelp& command : commands)
    for (const FlagHelp& flag : command.flags)
      if (!flag.positional()) script += fish_flag(command.name, flag);
  return script;
}

Run add_completions(Arguments& arguments, const CommonFlags&) {
  using Writer = std::string (*)(const std::vector<CommandHelp>&);
  static const std::map<std::string, Writer> writers = {
      {"bash", bash_completion}, {"fish", fish_completion}, {"man", manual_page}, {"zsh", zsh_completion}};
  const auto what = std::make_shared<std::string>();
  arguments.add_positional("WHAT", *what, "bash, zsh or fish; or man: the manual page, in roff")
      .required()
      .one_of({"bash", "zsh", "fish", "man"});
  return [what] {
    fmt::print("{}", writers.at(*what)(command_helps()));
    return 0;
  };
}

}  // namespace castray::cli
