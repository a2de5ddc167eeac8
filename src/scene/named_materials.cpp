#include "scene/named_materials.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/nearest.h"
#include "core/text.h"
#include "scene/material_reader.h"

namespace castray {

namespace {

bool is_pair(const JsonNode& node) {
  return std::ranges::any_of(node.children, [](const JsonNode& member) {
    return member.key == "type" && member.type == JsonNode::Type::string && member.text == pair_type;
  });
}

std::string name_of_side(std::string_view pair, const JsonNode& side) {
  return fmt::format("{} ({})", pair, side.key);
}

/// What light may do at one side must not depend on the other.
void check_sides(const JsonNode& front_node, const Material& front, const JsonNode& back_node,
                 const Material& back) {
  for (const auto& [node, side] : {std::pair(&front_node, &front), std::pair(&back_node, &back)})
    if (side->type == MaterialType::dielectric || side->transmission > 0)
      throw InputError(
          node->place,
          fmt::format("\"{}\" cannot be glass, through which light gets to the other side", node->key));
    else if (side->emits() && side->two_sided_emission)
      throw InputError(
          node->place,
          fmt::format("\"{}\" of a pair cannot emit on both sides: each emits on its own", node->key));
  if (front.coverage != back.coverage ||
      front.map(SurfaceParameter::coverage) != back.map(SurfaceParameter::coverage))
    throw InputError(back_node.place, "\"front\" and \"back\" must have the same \"coverage\"");
}

}  // namespace

void NamedMaterials::read(const JsonNode& node) {
  if (node.type != JsonNode::Type::object)
    throw InputError(node.place, fmt::format("\"materials\" must be an object, not {}", node.type_name()));
  for (const JsonNode& member : node.children)
    indices_[member.key] = builder_.add_material(is_pair(member) ? Material{.name = member.key, .back = 0}
                                                                 : read_material(member, file_, builder_));
  for (const JsonNode& member : node.children)
    if (is_pair(member)) read_pair(member);
}

std::uint16_t NamedMaterials::find(const JsonNode& node, std::string_view name) const {
  const auto found = indices_.find(read_string(node, name));
  if (found != indices_.end()) return found->second;
  throw InputError(node.place, not_found("material", node.text, names_in(indices_)));
}

void NamedMaterials::read_pair(const JsonNode& node) {
  const ObjectReader reader(node, fmt::format("material '{}' ({})", printable(node.key), pair_type),
                            pair_keys());
  const JsonNode &front_node = reader.require("front"), &back_node = reader.require("back");
  const std::uint16_t front = index_of_side(front_node, node.key), back = index_of_side(back_node, node.key);
  std::vector<Material>& materials = builder_.scene.materials;
  check_sides(front_node, materials[front], back_node, materials[back]);
  Material pair = materials[front];
  pair.name = node.key;
  pair.back = materials[back].emits() ? emitting_back(back, back_node, node.key) : back;
  materials[indices_.at(node.key)] = std::move(pair);
}

/// The same material, which emits backwards: a copy where others may have it, too.
std::uint16_t NamedMaterials::emitting_back(std::uint16_t back, const JsonNode& node, std::string_view pair) {
  if (node.type == JsonNode::Type::string) {
    Material copy = builder_.scene.materials[back];
    copy.name = name_of_side(pair, node);
    back = builder_.add_material(std::move(copy));
  }
  builder_.scene.materials[back].emits_backwards = true;
  return back;
}

/// A material by its name, or one of the pair's own.
std::uint16_t NamedMaterials::index_of_side(const JsonNode& node, std::string_view pair) {
  const bool own = node.type == JsonNode::Type::object;
  if (!own && node.type != JsonNode::Type::string)
    throw InputError(
        node.place, fmt::format("\"{}\" must be a material or its name, not {}", node.key, node.type_name()));
  const bool nested = own ? is_pair(node) : builder_.scene.materials[find(node, node.key)].has_back();
  if (nested) throw InputError(node.place, fmt::format("\"{}\" cannot be a pair itself", node.key));
  if (!own) return find(node, node.key);
  Material side = read_material(node, file_, builder_);
  side.name = name_of_side(pair, node);
  return builder_.add_material(std::move(side));
}

const std::vector<std::string_view>& pair_keys() {
  static const std::vector<std::string_view> keys{"type", "front", "back"};
  return keys;
}

}  // namespace castray
