#pragma once

#include <stdexcept>
#include <string>

namespace castray {

/// Where in a user's file something is wrong. Lines and columns count from 1; 0 means unknown.
struct SourcePlace {
  std::string file;
  int line = 0;
  int column = 0;
};

/// "FILE:LINE:COL: message", without what is unknown.
std::string placed(const SourcePlace& place, const std::string& message);

/// Something the user gave (a file, a flag, an environment variable) cannot be used. `what()` is one line,
/// "FILE:LINE:COL: what is wrong, and what to do", without the program's name. The program exits with 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  InputError(const SourcePlace& place, const std::string& message);
};

}  // namespace castray
