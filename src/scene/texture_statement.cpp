#include "scene/texture_statement.h"

#include <algorithm>
#include <iterator>

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

}  // namespace

TextureStatement read_texture_statement(LineReader& line) {
  TextureStatement statement;
  for (;;) {
    const auto option = std::ranges::find(options, line.peek(), &Option::name);
    if (option == std::end(options)) break;
    line.word();
    for (int i = 0; i < option->words; ++i) line.word();
    for (int i = 0; i < option->numbers; ++i) {
      const std::optional<double> value = parse_number(line.peek());
      if (!value) break;
      line.word();
      const auto axis = static_cast<std::size_t>(i);
      if (option->name == "-s" && axis < 2) statement.map.scale[axis] = static_cast<float>(*value);
      if (option->name == "-o" && axis < 2) statement.map.offset[axis] = static_cast<float>(*value);
    }
    if (option->name != "-s" && option->name != "-o") statement.ignored_options.emplace_back(option->name);
  }
  statement.file = line.rest();
  if (statement.file.empty()) line.fail("a texture needs a file name");
  return statement;
}

}  // namespace castray
