#pragma once

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "core/files.h"

/// Commands of a page: the lines of one indented block.
struct CommandBlock {
  std::string
      mark;  ///< "long" or "elsewhere", from a comment <!-- mark: why --> in front of the block; or empty
  std::size_t line = 0;
  std::vector<std::string> commands;
};

/// README.md, CONTRIBUTING.md and docs/*.md.
inline std::vector<std::filesystem::path> pages() {
  const std::filesystem::path root = CASTRAY_ROOT;
  std::vector<std::filesystem::path> all = {root / "README.md", root / "CONTRIBUTING.md"};
  for (const auto& entry : std::filesystem::directory_iterator(root / "docs"))
    if (entry.path().extension() == ".md") all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

inline std::vector<std::string> lines_of(const std::filesystem::path& page) {
  std::istringstream text(castray::read_file(page));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// The word of a line that is a comment "<!-- word: ..." or "<!-- word -->".
inline std::string mark_of(const std::string& line) {
  constexpr std::string_view begin = "<!-- ";
  if (!line.starts_with(begin)) return "";
  return line.substr(begin.size(), line.find_first_of(": ", begin.size()) - begin.size());
}

/// The indented blocks of a page outside fences and lists, in order. A line that ends in '\' goes on in the
/// next.
inline std::vector<CommandBlock> command_blocks(const std::filesystem::path& page) {
  constexpr std::string_view indent = "    ";
  std::vector<CommandBlock> blocks;
  std::string mark;
  bool fenced = false, in_block = false, goes_on = false;
  const std::vector<std::string> lines = lines_of(page);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string& line = lines[i];
    if (line.starts_with("```")) fenced = !fenced;
    const bool indented = !fenced && line.starts_with(indent);
    if (indented && (in_block || i == 0 || lines[i - 1].empty())) {
      if (!in_block) blocks.push_back({mark, i + 1, {}});
      auto& commands = blocks.back().commands;
      if (goes_on)
        commands.back() += "\n" + line.substr(indent.size());
      else
        commands.push_back(line.substr(indent.size()));
      goes_on = line.ends_with('\\');
      in_block = true;
      continue;
    }
    in_block = false;
    if (!line.empty()) mark = mark_of(line);
  }
  return blocks;
}

/// What stands between single backticks outside fences, in lines that are not commands.
inline std::vector<std::string> inline_code(const std::filesystem::path& page) {
  std::vector<std::string> codes;
  bool fenced = false;
  for (const std::string& line : lines_of(page)) {
    if (line.starts_with("```")) fenced = !fenced;
    if (fenced || line.starts_with("    ")) continue;
    for (std::size_t begin = line.find('`'); begin != line.npos;) {
      const std::size_t end = line.find('`', begin + 1);
      if (end == line.npos) break;
      codes.push_back(line.substr(begin + 1, end - begin - 1));
      begin = line.find('`', end + 1);
    }
  }
  return codes;
}
