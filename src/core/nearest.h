#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace castray {

/// The name of `known` that `word` most likely was meant to be, by edit distance; empty where none is near.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& known);

/// "; did you mean 'NAME'?" or, where nothing is near, "; known: A, B, C".
std::string suggestion(std::string_view word, const std::vector<std::string_view>& known);

}  // namespace castray
