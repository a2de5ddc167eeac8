#include "cli/values.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "castray/error.h"
#include "core/nearest.h"
#include "core/text.h"

namespace castray::cli {

namespace {

/// Whether all of `text` is one number of type T, without leading blanks or plus sign.
template <class T>
bool read_all(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::uint64_t parse_whole(const std::string& flag, const std::string& text, std::uint64_t least,
                          std::uint64_t most) {
  std::uint64_t value = 0;
  if (!read_all(text, value) || value < least || value > most)
    throw InputError(fmt::format("--{} '{}': must be a whole number between {} and {}", flag, printable(text),
                                 least, most));
  return value;
}

double parse_number(const std::string& flag, const std::string& text) {
  double value = 0;
  if (!read_all(text, value) || !std::isfinite(value))
    throw InputError(fmt::format("--{} '{}': must be a number", flag, printable(text)));
  return value;
}

Vec3d parse_vector(const std::string& flag, const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 3) throw InputError(fmt::format("--{} '{}': must be X,Y,Z", flag, printable(text)));
  return {parse_number(flag, parts[0]), parse_number(flag, parts[1]), parse_number(flag, parts[2])};
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find(separator, begin)) != std::string::npos; begin = end + 1)
    parts.push_back(text.substr(begin, end - begin));
  parts.push_back(text.substr(begin));
  return parts;
}

void refuse_choice(const std::string& flag, const std::string& text,
                   const std::vector<std::string_view>& names) {
  throw InputError(
      fmt::format("--{}: '{}' is none of its values{}", flag, printable(text), suggestion(text, names)));
}

}  // namespace castray::cli
