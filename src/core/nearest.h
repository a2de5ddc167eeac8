#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace castray {

/// The name of `known` that `word` most likely was meant to be, by edit distance; empty where none is near.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& known);

/// "; did you mean 'NAME'?" or, where nothing is near, "; known: A, B, C".
std::string suggestion(std::string_view word, const std::vector<std::string_view>& known);

/// What to say where no member of "`kind`s" has this name.
std::string not_found(std::string_view kind, std::string_view name,
                      const std::vector<std::string_view>& known);

template <class Value>
std::vector<std::string_view> names_in(const std::map<std::string, Value>& members) {
  std::vector<std::string_view> names;
  for (const auto& member : members) names.push_back(member.first);
  return names;
}

}  // namespace castray
