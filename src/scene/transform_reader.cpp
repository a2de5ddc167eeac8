#include "scene/transform_reader.h"

#include <fmt/core.h>

#include "castray/error.h"
#include "core/files.h"
#include "core/text.h"
#include "scene/file_finder.h"
#include "scene/json_reader.h"
#include "scene/line_reader.h"

namespace castray {

namespace {

constexpr std::size_t matrix_numbers = 12;

Transform from_numbers(const std::vector<double>& n) {
  return {{{n[0], n[1], n[2]}, {n[4], n[5], n[6]}, {n[8], n[9], n[10]}}, {n[3], n[7], n[11]}};
}

void check(const Transform& transform, const SourcePlace& place) {
  if (!transform.is_invertible())
    throw InputError(place, "the matrix flattens space, or is not finite: it needs an inverse");
}

Transform read_matrix(const JsonNode& node, std::string_view name) {
  const Transform matrix = from_numbers(read_numbers(node, name, matrix_numbers, coordinate_range));
  check(matrix, node.place);
  return matrix;
}

Transform read_step(const JsonNode& node) {
  const ObjectReader step(node, "a transform step", transform_step_keys);
  if (node.children.size() != 1)
    throw InputError(node.place,
                     "a transform step has one key: \"scale\", \"rotate\", \"translate\" or \"matrix\"");
  if (const JsonNode* scale = step.find("scale")) {
    const bool uniform = scale->type == JsonNode::Type::number;
    const Vec3d factors = uniform ? Vec3d(read_number(*scale, "\"scale\"", coordinate_range))
                                  : read_vector(*scale, "\"scale\"", coordinate_range);
    if (factors.x == 0 || factors.y == 0 || factors.z == 0)
      throw InputError(scale->place, "\"scale\" must not be 0: nothing would be left");
    return Transform::scale(factors);
  }
  if (const JsonNode* rotate = step.find("rotate")) {
    const std::vector<double> numbers = read_numbers(*rotate, "\"rotate\"", 4, coordinate_range);
    const Vec3d axis{numbers[0], numbers[1], numbers[2]};
    if (axis == Vec3d{}) throw InputError(rotate->place, "\"rotate\" needs an axis that is not (0,0,0)");
    return Transform::rotate(axis, numbers[3]);
  }
  if (const JsonNode* matrix = step.find("matrix")) return read_matrix(*matrix, "\"matrix\"");
  return Transform::translate(read_vector(step.require("translate"), "\"translate\"", coordinate_range));
}

std::vector<Transform> read_transform_file(const JsonNode& node, const std::filesystem::path& scene_file) {
  const std::filesystem::path path = file_named_by(node, "\"transforms\"", scene_file);
  const std::string text = read_file(path);
  LineReader reader(text, path.string());
  std::vector<Transform> transforms;
  std::vector<double> numbers(matrix_numbers);
  while (reader.next_line()) {
    for (double& number : numbers) number = reader.required_number("12 numbers of a transform");
    if (!reader.word().empty()) reader.fail("more than the 12 numbers of a transform");
    transforms.push_back(from_numbers(numbers));
    check(transforms.back(), reader.place());
  }
  if (transforms.empty())
    throw InputError(SourcePlace{path.string()}, "no transforms: it needs 12 numbers a line");
  return transforms;
}

}  // namespace

Transform read_transform(const JsonNode& node) {
  Transform transform;
  for (const JsonNode& step : read_array(node, "\"transform\"")) transform = transform.then(read_step(step));
  return transform;
}

std::vector<Transform> read_transforms(const JsonNode& node, const std::filesystem::path& scene_file) {
  if (node.type == JsonNode::Type::string) return read_transform_file(node, scene_file);
  std::vector<Transform> transforms;
  for (const JsonNode& matrix : read_array(node, "\"transforms\""))
    transforms.push_back(read_matrix(matrix, fmt::format("\"transforms\"[{}]", transforms.size())));
  return transforms;
}

}  // namespace castray
