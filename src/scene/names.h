#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace castray {

/// Whether `c` separates the words of an OBJ or MTL line.
constexpr bool is_space(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0'; }

/// `text` without the white space around it.
constexpr std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// `text` up to the first '#' that follows white space, trimmed.
std::string_view without_comment(std::string_view text);

/// What a name at the end of an OBJ or MTL line may mean, the likeliest first: as it stands, without quotes,
/// without escapes ("\ " and "%20").
std::vector<std::string> spellings(std::string_view text);

/// `text` without its last comment, without its last two, and so on: each begins with a '#' behind white
/// space.
std::vector<std::string_view> without_comments(std::string_view text);

/// The spellings of `text`, then those without comments. Names may hold spaces and '#', so only what exists
/// can decide.
std::vector<std::string> readings(std::string_view text);

/// The names, of which each that was there before gets a number: "oak", "oak 2".
std::vector<std::string> without_repeats(std::vector<std::string> names);

/// ASCII letters in lower case.
std::string lower_case(std::string_view text);

}  // namespace castray
