#include "scene/json_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/nearest.h"
#include "core/text.h"

namespace castray {

namespace {

void expect(const JsonNode& node, JsonNode::Type type, std::string_view name, std::string_view expected) {
  if (node.type != type)
    throw InputError(node.place, fmt::format("{} must be {}, not {}", name, expected, node.type_name()));
}

}  // namespace

double read_number(const JsonNode& node, std::string_view name, const Range& range) {
  expect(node, JsonNode::Type::number, name, "a number");
  if (!range.contains(node.number))
    throw InputError(node.place,
                     fmt::format("{} must be {}, not {}", name, range.text(), printable(node.text)));
  return node.number;
}

int read_integer(const JsonNode& node, std::string_view name, int least, int greatest) {
  const double value = read_number(
      node, name, {.least = static_cast<double>(least), .greatest = static_cast<double>(greatest)});
  if (value != std::floor(value))
    throw InputError(node.place,
                     fmt::format("{} must be a whole number, not {}", name, printable(node.text)));
  return static_cast<int>(value);
}

const std::string& read_string(const JsonNode& node, std::string_view name) {
  expect(node, JsonNode::Type::string, name, "a string");
  return node.text;
}

bool read_boolean(const JsonNode& node, std::string_view name) {
  expect(node, JsonNode::Type::boolean, name, "true or false");
  return node.number != 0;
}

std::vector<double> read_numbers(const JsonNode& node, std::string_view name, std::size_t count,
                                 const Range& range) {
  const std::string expected = fmt::format("an array of {} numbers", count);
  expect(node, JsonNode::Type::array, name, expected);
  if (node.children.size() != count)
    throw InputError(node.place,
                     fmt::format("{} must be {}, but has {}", name, expected, node.children.size()));
  std::vector<double> numbers;
  for (const JsonNode& child : node.children)
    numbers.push_back(read_number(child, fmt::format("{}[{}]", name, numbers.size()), range));
  return numbers;
}

Vec3d read_vector(const JsonNode& node, std::string_view name, const Range& range) {
  const std::vector<double> numbers = read_numbers(node, name, 3, range);
  return {numbers[0], numbers[1], numbers[2]};
}

Vec3d read_color(const JsonNode& node, std::string_view name, const Range& range) {
  return node.type == JsonNode::Type::number ? Vec3d(read_number(node, name, range))
                                             : read_vector(node, name, range);
}

const std::vector<JsonNode>& read_array(const JsonNode& node, std::string_view name) {
  expect(node, JsonNode::Type::array, name, "an array");
  return node.children;
}

ObjectReader::ObjectReader(const JsonNode& node, std::string_view name,
                           const std::vector<std::string_view>& keys)
    : node_(node), name_(name) {
  expect(node, JsonNode::Type::object, name, "an object");
  for (const JsonNode& member : node.children)
    if (std::find(keys.begin(), keys.end(), member.key) == keys.end())
      throw InputError(member.key_place, fmt::format("unknown key '{}' in {}{}", printable(member.key), name,
                                                     suggestion(member.key, keys)));
}

const JsonNode* ObjectReader::find(std::string_view key) const {
  for (const JsonNode& member : node_.children)
    if (member.key == key) return &member;
  return nullptr;
}

const JsonNode& ObjectReader::require(std::string_view key) const {
  const JsonNode* member = find(key);
  if (!member) throw InputError(node_.place, fmt::format("{} needs the key '{}'", name_, key));
  return *member;
}

}  // namespace castray
