#include <fmt/format.h>

#include "cli/command_help.h"

namespace castray::cli {

namespace {

/// Text as roff shows it unchanged.
std::string roff(const std::string& text) {
  std::string out = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else
      out += c;
  }
  return out;
}

std::string flag_entry(const FlagHelp& flag) {
  std::string names;
  for (const std::string& name : flag.names)
    names += (names.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
  if (!flag.metavar.empty()) names += " \\fI" + roff(flag.metavar) + "\\fR";
  return ".TP\n" + names + "\n" + roff(flag.help) + "\n";
}

std::string command_section(const CommandHelp& command) {
  std::string synopsis = ".B castray " + command.name + "\n[flags]";
  std::string entries, group = "Options";
  for (const FlagHelp& flag : command.flags) {
    if (flag.positional())
      synopsis += " \\fI" + roff(flag.names.front()) + (flag.repeatable ? "\\fR..." : "\\fR");
    if (!flag.positional() && flag.group != group) entries += ".PP\n" + roff(group = flag.group) + ":\n";
    entries += flag_entry(flag);
  }
  std::string text = ".SS castray " + command.name + "\n" + synopsis + "\n.PP\n" + roff(command.description) +
                     ".\n" + entries;
  if (!command.footer.empty()) text += ".PP\n" + roff(command.footer) + "\n";
  return text;
}

}  // namespace

std::string manual_page(const std::vector<CommandHelp>& commands) {
  std::string page = ".TH CASTRAY 1 \"\" \"castray " CASTRAY_VERSION R"("
.SH NAME
castray \- renders triangle scenes by path tracing on the CPU
.SH SYNOPSIS
.B castray
.I command
[flags]
.SH COMMANDS
)";
  for (const CommandHelp& command : commands) page += command_section(command);
  return page + R"(.SH EXIT STATUS
0: done.
1: compared and different, or stopped early.
2: usage, input or output error, told in one line.
130: interrupted, with what was rendered saved.
)";
}

}  // namespace castray::cli
