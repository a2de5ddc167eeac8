#pragma once

#include <iterator>
#include <sstream>
#include <string>
#include <vector>

/// The parts of `text` between white space.
inline std::vector<std::string> words_of(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}
