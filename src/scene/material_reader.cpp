#include "scene/material_reader.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/nearest.h"
#include "core/text.h"
#include "materials/descriptor.h"
#include "materials/media.h"
#include "scene/file_finder.h"
#include "scene/named_metals.h"

namespace castray {

namespace {

using Kind = MaterialKey::Kind;

std::string quoted(std::string_view key) { return fmt::format("\"{}\"", key); }

std::array<float, 2> read_pair(const JsonNode& node, std::string_view name) {
  const std::vector<double> numbers = read_numbers(node, name, 2, float_range);
  return {static_cast<float>(numbers[0]), static_cast<float>(numbers[1])};
}

class MaterialReader {
 public:
  MaterialReader(const JsonNode& node, const std::filesystem::path& file, SceneBuilder& builder)
      : node_(node), file_(file), builder_(builder) {}

  Material read() {
    std::vector<std::string_view> all_keys{"type"}, type_names;
    for (const MaterialDescriptor* known : material_descriptors()) {
      type_names.push_back(known->name);
      for (const MaterialKey& key : known->keys)
        if (std::ranges::find(all_keys, key.name) == all_keys.end()) all_keys.push_back(key.name);
    }
    type_names.push_back(pair_type);
    const std::string name = fmt::format("material '{}'", printable(node_.key));
    // First the type, as the keys depend on it.
    const ObjectReader any(node_, name, all_keys);
    const MaterialDescriptor& descriptor =
        *material_descriptors()[choose(any.require("type"), "material type", type_names)];
    std::vector<std::string_view> keys{"type"};
    for (const MaterialKey& key : descriptor.keys) keys.push_back(key.name);
    const ObjectReader reader(node_, fmt::format("{} ({})", name, descriptor.name), keys);
    material_.name = node_.key;
    material_.type = descriptor.type;
    const JsonNode* roughness = reader.find("roughness");
    if (roughness && reader.find("alpha"))
      throw InputError(roughness->key_place, "give \"roughness\" or \"alpha\" (= roughness^2), not both");
    for (const MaterialKey& key : descriptor.keys)
      if (const JsonNode* found = reader.find(key.name)) read_key(key, *found);
    if (material_.anisotropy > 0 && material_.multiple_scattering)
      throw InputError(reader.find("anisotropy")->key_place,
                       "\"anisotropy\" cannot go with \"multiple_scattering\", whose tables are of round "
                       "lobes; leave one of them out");
    if (material_.vertex_colors) material_.eta = material_.k = {};  // the colours change F
    check_thin(reader);
    check_glass_share(reader);
    check_stretched_layers(reader);
    return std::move(material_);
  }

 private:
  /// A thin wall is smooth and has no inside.
  void check_thin(const ObjectReader& reader) const {
    if (!material_.thin) return;
    for (const char* key : {"roughness", "alpha", "absorption"})
      if (const JsonNode* found = reader.find(key))
        throw InputError(
            found->key_place,
            fmt::format("\"{}\" cannot go with \"thin\": a thin wall is smooth, and has no inside; "
                        "tint what passes by \"transmittance\"",
                        key));
  }

  /// One share counts for the whole surface, and a lamp's light would have to leave both parts.
  void check_glass_share(const ObjectReader& reader) const {
    if (!(material_.transmission > 0)) return;
    const std::string advice =
        " cannot go with \"transmission\"; give a part of the mesh a material of its own";
    if (material_.map(SurfaceParameter::metallic).used())
      throw InputError(reader.find("metallic")->key_place, "an image of \"metallic\"" + advice);
    if (material_.emits()) throw InputError(reader.find("ke")->key_place, "\"ke\"" + advice);
  }

  void check_stretched_layers(const ObjectReader& reader) const {
    if (!(material_.anisotropy > 0)) return;
    switch (anisotropy_conflict(material_)) {
      case AnisotropyConflict::none:
        return;
      case AnisotropyConflict::emission:
        throw InputError(reader.find("ke")->key_place,
                         "\"ke\" cannot go with \"anisotropy\" of a principled material; give a part of "
                         "the mesh a material of its own");
      case AnisotropyConflict::roughness_image:
        throw InputError(
            reader.find("anisotropy")->key_place,
            "\"anisotropy\" of a principled material whose roughness is an image needs \"metallic\" "
            "1, a number: there is no base below the lobe then");
    }
  }

  void read_key(const MaterialKey& key, const JsonNode& node) {
    const bool is_map = key.parameter && node.type == JsonNode::Type::object && !is_index(key, node);
    if (key.name == "absorption" && node.type == JsonNode::Type::object) return read_absorption(node);
    if (key.kind == Kind::image_only || is_map)
      read_map(key, node);
    else
      read_constant(key, node, quoted(key.name));
  }

  void read_constant(const MaterialKey& key, const JsonNode& node, const std::string& name) {
    if (key.kind == Kind::color)
      read_color_of(key, node, name);
    else if (key.kind == Kind::flag)
      material_.*std::get<bool Material::*>(key.field) = read_boolean(node, name);
    else
      set_number(key, read_number(node, name, key.range));
  }

  /// By the colour that white light has after a distance.
  void read_absorption(const JsonNode& node) {
    const ObjectReader reader(node, "\"absorption\"", absorption_keys());
    constexpr Range color{.least = 0, .greatest = 1, .above_least = true};
    material_.absorption =
        absorption_of(read_color(reader.require("color"), "\"color\"", color),
                      read_number(reader.require("distance"), "\"distance\"", length_range));
  }

  static bool is_reflectance(const MaterialKey& key) {
    return key.kind == Kind::color && key.range.greatest <= 1;
  }

  /// Whether a reflectance is given by a complex index.
  static bool is_index(const MaterialKey& key, const JsonNode& node) {
    const auto is_part = [](const JsonNode& member) {
      return std::ranges::find(index_keys(), member.key) != index_keys().end();
    };
    return is_reflectance(key) && std::ranges::any_of(node.children, is_part);
  }

  /// A reflectance may be a metal's, by its name or its index.
  void read_color_of(const MaterialKey& key, const JsonNode& node, const std::string& name) {
    if (is_index(key, node)) {
      const ObjectReader index(node, name, index_keys());
      const Vec3d eta = read_color(index.require("eta"), "\"eta\"", index_range),
                  k = read_color(index.require("k"), "\"k\"", {.least = 0, .greatest = index_range.greatest});
      set_metal(key, {name, reflectance_of_index(eta, k), eta, k});
    } else if (node.type == JsonNode::Type::string && is_reflectance(key)) {
      std::vector<std::string_view> names;
      for (const NamedMetal& metal : named_metals()) names.push_back(metal.name);
      set_metal(key, named_metals()[choose(node, "metal", names)]);
    } else {
      material_.*std::get<Vec3d Material::*>(key.field) = read_color(node, name, key.range);
    }
  }

  /// A metal's reflectance follows from the index at each angle.
  void set_metal(const MaterialKey& key, const NamedMetal& metal) {
    material_.*std::get<Vec3d Material::*>(key.field) = metal.reflectance;
    if (!takes_index(key, material_.type)) return;
    material_.eta = metal.eta;
    material_.k = metal.k;
  }

  void set_number(const MaterialKey& key, double value) {
    material_.*std::get<double Material::*>(key.field) = key.kind == Kind::squared ? value * value : value;
  }

  void read_map(const MaterialKey& key, const JsonNode& node) {
    const ObjectReader reader(node, quoted(key.name), map_keys());
    TextureMap map;
    if (const JsonNode* scale = reader.find("scale")) map.scale = read_pair(*scale, "\"scale\"");
    if (const JsonNode* offset = reader.find("offset")) map.offset = read_pair(*offset, "\"offset\"");
    if (const JsonNode* clamp = reader.find("clamp")) map.clamp = read_boolean(*clamp, "\"clamp\"");
    if (const JsonNode* base = reader.find("base"))
      map.base = static_cast<float>(read_number(*base, "\"base\"", float_range));
    if (const JsonNode* gain = reader.find("gain"))
      map.gain = static_cast<float>(read_number(*gain, "\"gain\"", float_range));
    if (const JsonNode* channel = reader.find("channel"))
      map.channel = static_cast<Channel>(choose(*channel, "channel", channel_names()));
    if (const JsonNode* filter = reader.find("filter")) map.filter = read_filter(key, *filter);
    ColorSpace space = key.kind == Kind::color ? ColorSpace::srgb : ColorSpace::linear;
    if (const JsonNode* named = reader.find("color_space"))
      space = choose(*named, "colour space", {"srgb", "linear"}) == 0 ? ColorSpace::srgb : ColorSpace::linear;
    read_factor(key, reader.find("factor"));
    if (takes_index(key, material_.type)) material_.eta = material_.k = {};  // the image is F
    const std::filesystem::path path = file_named_by(reader.require("image"), "\"image\"", file_);
    map.texture = builder_.add_texture(path, space, meaning_of(key));
    material_.map(*key.parameter) = map;
  }

  static TextureFilter read_filter(const MaterialKey& key, const JsonNode& node) {
    const auto filter = static_cast<TextureFilter>(choose(node, "filter", filter_names()));
    if (filter != TextureFilter::none && !is_reflectance(key))
      throw InputError(node.key_place, fmt::format("\"{}\" cannot be filtered: only colours of what is "
                                                   "reflected or transmitted; leave \"filter\" out",
                                                   key.name));
    return filter;
  }

  static TextureMeaning meaning_of(const MaterialKey& key) {
    if (key.parameter == SurfaceParameter::normal || key.parameter == SurfaceParameter::anisotropy_direction)
      return TextureMeaning::normals;
    return key.parameter == SurfaceParameter::bump ? TextureMeaning::heights : TextureMeaning::amounts;
  }

  /// An image without a factor is taken as it is.
  void read_factor(const MaterialKey& key, const JsonNode* factor) {
    if (factor && key.kind == Kind::image_only)
      throw InputError(factor->key_place, fmt::format("\"{}\" has no factor; use \"gain\"", key.name));
    if (factor)
      read_constant(key, *factor, "\"factor\"");
    else if (key.kind == Kind::color)
      material_.*std::get<Vec3d Material::*>(key.field) = Vec3d(1);
    else if (key.kind != Kind::image_only)
      set_number(key, 1);
  }

  const JsonNode& node_;
  const std::filesystem::path& file_;
  SceneBuilder& builder_;
  Material material_{.name = {}};
};

}  // namespace

Material read_material(const JsonNode& node, const std::filesystem::path& file, SceneBuilder& builder) {
  return MaterialReader(node, file, builder).read();
}

const std::vector<std::string_view>& map_keys() {
  static const std::vector<std::string_view> keys{"image",   "factor",      "scale", "offset", "clamp",
                                                  "channel", "color_space", "base",  "gain",   "filter"};
  return keys;
}

const std::vector<std::string_view>& absorption_keys() {
  static const std::vector<std::string_view> keys{"color", "distance"};
  return keys;
}

const std::vector<std::string_view>& index_keys() {
  static const std::vector<std::string_view> keys{"eta", "k"};
  return keys;
}

std::size_t choose(const JsonNode& node, std::string_view name, const std::vector<std::string_view>& names) {
  const std::string& text = read_string(node, name);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == text) return i;
  throw InputError(node.place,
                   fmt::format("unknown {} '{}'{}", name, printable(text), suggestion(text, names)));
}

}  // namespace castray
