#include "scene/pretty_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace castray {

namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t longest_line = 110;

/// `text` of each member or element, between brackets.
template <class Text>
std::string joined(const Json& value, const std::string& before, const std::string& between,
                   const std::string& after, const Text& text) {
  std::string all = value.is_object() ? "{" : "[";
  for (auto member = value.begin(); member != value.end(); ++member) {
    all += member == value.begin() ? before : between;
    if (value.is_object()) all += Json(member.key()).dump() + ": ";
    all += text(*member);
  }
  return all + after + (value.is_object() ? "}" : "]");
}

std::string in_one_line(const Json& value) {
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  if (!value.is_structured()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
  const char* space = value.is_object() ? " " : "";
  return joined(value, space, ", ", space, in_one_line);
}

std::string pretty(const Json& value, std::size_t indent) {
  std::string line = in_one_line(value);
  const bool is_flat =
      !value.is_object() || std::ranges::none_of(value, [](const Json& v) { return v.is_object(); });
  if (!value.is_structured() || (is_flat && indent + line.size() <= longest_line)) return line;
  const std::string margin(indent, ' ');
  return joined(value, "\n" + margin + "  ", ",\n" + margin + "  ", "\n" + margin,
                [indent](const Json& v) { return pretty(v, indent + 2); });
}

}  // namespace

std::string pretty_json(const Json& value) { return pretty(value, 0); }

}  // namespace castray
