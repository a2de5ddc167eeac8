// The words of a command line, one on each line; and, behind a '=', "flag value" pairs as a scene or the
// command line gives them to a render.
#include <algorithm>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "cli/render_flags.h"
#include "fuzz.h"

namespace {

using namespace castray;

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, text.substr(0, end).find('\0')));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

void parse_words(std::string_view text) {
  const std::vector<std::string> words = lines_of(text);
  std::vector<const char*> argv{"castray"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  argv.push_back(nullptr);
  cli::parse_command_line(static_cast<int>(argv.size()) - 1, argv.data());
}

void set_flags(std::string_view text) {
  Scene scene;
  for (const std::string& line : lines_of(text)) {
    const std::size_t space = std::min(line.find(' '), line.size());
    scene.render_defaults.push_back(
        {line.substr(0, space), line.substr(std::min(space + 1, line.size())), {}});
  }
  cli::RenderRequest request;
  cli::apply_defaults(request, scene);
}

}  // namespace

FUZZ(text) {
  if (text.starts_with('='))
    set_flags(text.substr(1));
  else
    parse_words(text);
}
