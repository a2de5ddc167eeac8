#pragma once

#include <string>
#include <vector>

namespace castray::cli {

/// One flag, or one argument known by its place, as the help tells it.
struct FlagHelp {
  std::vector<std::string> names;  ///< "-o", "--output"; the bare name of an argument known by its place
  std::string metavar;             ///< stands for its value; empty for a switch
  std::string help, group;
  bool repeatable = false;

  bool positional() const { return names.front().front() != '-'; }
  /// The values that the metavar lists: "auto" and "16" of "auto|16"; none of "gamma:G" or "FILE".
  std::vector<std::string> choices() const;
  bool takes_file() const { return positional() || metavar.starts_with("FILE"); }
};

struct CommandHelp {
  std::string name, description, footer;
  std::vector<FlagHelp> flags;
};

/// All commands, in the order of the help. Man page and completions are made from it.
std::vector<CommandHelp> command_helps();

// Texts made from the helps: what each shell sources, and a man page in roff.
std::string bash_completion(const std::vector<CommandHelp>& commands);
std::string zsh_completion(const std::vector<CommandHelp>& commands);
std::string fish_completion(const std::vector<CommandHelp>& commands);
std::string manual_page(const std::vector<CommandHelp>& commands);

}  // namespace castray::cli
