#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "castray/error.h"

namespace castray {

/// A JSON value that knows where in its file it stands.
struct JsonNode {
  enum class Type { null, boolean, number, string, array, object };

  Type type = Type::null;
  SourcePlace place{};  ///< of its first character
  std::string text{};   ///< of a string its content, of a number its digits
  double number = 0;    ///< of a number; of a boolean 0 or 1
  std::string key{};    ///< where it is a member of an object
  SourcePlace key_place{};
  std::vector<JsonNode> children{};

  /// "a number", "an object", ...
  const char* type_name() const;
};

/// Parses JSON with comments. Throws InputError with file, line and column of the first syntax error.
JsonNode parse_json(std::string_view text, const std::string& file);

}  // namespace castray
