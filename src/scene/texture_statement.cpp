#include "scene/texture_statement.h"

#include <algorithm>
#include <iterator>

#include "scene/names.h"

namespace castray {

namespace {

/// An option and what follows it: one word, or up to some numbers, of which the last may be left out.
struct Option {
  std::string_view name;
  int words, numbers;
};
constexpr Option options[] = {{"-s", 0, 3},      {"-o", 0, 3},         {"-t", 0, 3},      {"-mm", 0, 2},
                              {"-bm", 0, 1},     {"-boost", 0, 1},     {"-texres", 0, 1}, {"-blendu", 1, 0},
                              {"-blendv", 1, 0}, {"-clamp", 1, 0},     {"-cc", 1, 0},     {"-imfchan", 1, 0},
                              {"-type", 1, 0},   {"-colorspace", 1, 0}};

/// Takes over an option with its word, or the first `count` of its numbers. False: it means nothing here.
bool take(TextureStatement& statement, std::string_view option, std::string_view word,
          const std::array<double, 3>& numbers, int count) {
  if (option == "-s" || option == "-o") {
    std::array<double, 2>& values = option == "-s" ? statement.scale : statement.offset;
    std::copy_n(numbers.begin(), std::min(count, 2), values.begin());
  } else if (option == "-clamp") {
    statement.clamp = word == "on";
  } else if (option == "-mm") {
    if (count > 0) statement.base = numbers[0];
    if (count > 1) statement.gain = numbers[1];
  } else if (option == "-bm") {
    if (count > 0) statement.bump = numbers[0];
  } else if (option == "-imfchan") {
    statement.channel = word.empty() ? '\0' : word.front();
  } else if (option == "-colorspace") {
    statement.color_space = word;
  } else {
    return false;
  }
  return true;
}

void read_options(LineReader& line, TextureStatement& statement) {
  for (;;) {
    const auto option = std::ranges::find(options, line.peek(), &Option::name);
    if (option == std::end(options)) return;
    line.word();
    const std::string_view word = option->words > 0 ? line.word() : std::string_view();
    std::array<double, 3> numbers{};
    int count = 0;
    for (; count < option->numbers; ++count) {
      const std::optional<double> value = parse_number(line.peek());
      if (!value) break;
      line.word();
      numbers[static_cast<std::size_t>(count)] = *value;
    }
    if (!take(statement, option->name, word, numbers, count))
      statement.ignored_options.emplace_back(option->name);
  }
}

/// Where in `name` the first word that is an option begins; its end where none is.
std::size_t first_option(std::string_view name) {
  for (std::size_t at = name.find('-'); at < name.size(); at = name.find('-', at + 1)) {
    const std::string_view word = name.substr(at, name.find_first_of(" \t", at) - at);
    if (at > 0 && is_space(name[at - 1]) &&
        std::ranges::find(options, word, &Option::name) != std::end(options))
      return at;
  }
  return name.size();
}

/// Takes the options off that some programs write behind the name.
void read_options_behind(std::string_view& name, TextureStatement& statement) {
  const std::size_t end = first_option(name);
  LineReader behind(name.substr(end), statement.place.file);
  TextureStatement with = statement;
  if (!behind.next_line()) return;
  read_options(behind, with);
  if (!behind.at_end()) return;  // a name with a word like an option
  statement = with;
  name = trimmed(name.substr(0, end));
}

}  // namespace

TextureStatement read_texture_statement(const std::string& key, LineReader& line) {
  TextureStatement statement;
  statement.key = key;
  statement.place = line.place();
  read_options(line, statement);
  std::string_view name = line.rest();
  read_options_behind(name, statement);
  statement.file = name;
  return statement;
}

}  // namespace castray
