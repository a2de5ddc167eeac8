#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "castray/vec.h"

namespace castray::cli {

// Values of flags. Each throws InputError that names the flag, what was given and what is expected.

/// A whole number in [least, most].
std::uint64_t parse_whole(const std::string& flag, const std::string& text, std::uint64_t least,
                          std::uint64_t most);

/// A finite number.
double parse_number(const std::string& flag, const std::string& text);

/// X,Y,Z.
Vec3d parse_vector(const std::string& flag, const std::string& text);

/// `text` cut at each `separator`.
std::vector<std::string> split(const std::string& text, char separator);

/// What `what` stands for; the error suggests the nearest of the names.
[[noreturn]] void refuse_choice(const std::string& flag, const std::string& text,
                                const std::vector<std::string_view>& names);

/// The value that `text` names in `choices`.
template <class T, std::size_t N>
T parse_choice(const std::string& flag, const std::string& text,
               const std::pair<std::string_view, T> (&choices)[N]) {
  std::vector<std::string_view> names;
  for (const auto& [name, value] : choices) {
    if (name == text) return value;
    names.push_back(name);
  }
  refuse_choice(flag, text, names);
}

}  // namespace castray::cli
