#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "castray/vec.h"
#include "core/range.h"
#include "scene/json_document.h"

namespace castray {

// Each throws InputError with the node's place where the node is of another type or out of range. `name` is
// what the message calls the value.
double read_number(const JsonNode& node, std::string_view name, const Range& range = {});
int read_integer(const JsonNode& node, std::string_view name, int least, int greatest);
const std::string& read_string(const JsonNode& node, std::string_view name);
bool read_boolean(const JsonNode& node, std::string_view name);
Vec3d read_vector(const JsonNode& node, std::string_view name, const Range& range = {});
/// A number stands for three.
Vec3d read_color(const JsonNode& node, std::string_view name, const Range& range);
std::vector<double> read_numbers(const JsonNode& node, std::string_view name, std::size_t count,
                                 const Range& range = {});
const std::vector<JsonNode>& read_array(const JsonNode& node, std::string_view name);

/// An object whose keys are all known.
class ObjectReader {
 public:
  /// Throws InputError where the node is no object or has a key that is not in `keys`.
  ObjectReader(const JsonNode& node, std::string_view name, const std::vector<std::string_view>& keys);

  /// The member, or nullptr.
  const JsonNode* find(std::string_view key) const;
  /// The member; throws InputError where it is missing.
  const JsonNode& require(std::string_view key) const;

 private:
  const JsonNode& node_;
  std::string name_;
};

}  // namespace castray
