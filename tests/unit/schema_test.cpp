#include <catch2/catch.hpp>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "cli/render_flags.h"
#include "materials/descriptor.h"
#include "scene/scene_file.h"

using namespace castray;

namespace {

using Json = nlohmann::json;

Json schema() {
  return Json::parse(std::ifstream(std::string(CASTRAY_ROOT) + "/scenes/castray.schema.json"));
}

Json reference(const std::string& name) { return {{"$ref", "#/definitions/" + name}}; }

Json constant_schema(const MaterialKey& key) {
  if (key.kind == MaterialKey::Kind::image_only) return reference("map");
  if (key.kind == MaterialKey::Kind::flag) return {{"type", "boolean"}};
  const Range& r = key.range;
  const bool bounded = r.greatest < std::numeric_limits<double>::max();
  if (key.name == "absorption") return {{"anyOf", {reference("radiance"), reference("absorption")}}};
  if (key.kind == MaterialKey::Kind::color) return reference(r.greatest <= 1 ? "reflectance" : "radiance");
  Json number{{"type", "number"}, {r.above_least ? "exclusiveMinimum" : "minimum", r.least}};
  if (bounded) number["maximum"] = r.greatest;
  return number;
}

/// The schema of a material, by its descriptor.
Json material_schema(const MaterialDescriptor& material) {
  Json properties{
      {"type", {{"description", "Decides which other keys there are."}, {"const", material.name}}}};
  for (const MaterialKey& key : material.keys) {
    Json property = constant_schema(key);
    if (key.parameter && key.kind != MaterialKey::Kind::image_only)
      property = {{"anyOf", {property, reference("map")}}};
    property["description"] = key.text;
    properties[std::string(key.name)] = property;
  }
  return {{"description", material.text},
          {"type", "object"},
          {"additionalProperties", false},
          {"required", {"type"}},
          {"properties", properties}};
}

}  // namespace

TEST_CASE("the JSON Schema describes materials as their descriptors do") {
  const Json definitions = schema()["definitions"];
  Json choices = Json::array();
  for (const MaterialDescriptor* material : material_descriptors()) {
    const std::string name(material->name);
    const Json expected = material_schema(*material);
    INFO(name << " should be " << expected.dump(2));
    CHECK(definitions[name] == expected);
    choices.push_back(reference(name));
  }
  choices.push_back(reference("two_sided"));
  CHECK(schema()["properties"]["materials"]["additionalProperties"]["oneOf"] == choices);
}

TEST_CASE("docs/materials.md has a row for each material and each of its keys") {
  std::ifstream file(std::string(CASTRAY_ROOT) + "/docs/materials.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const MaterialDescriptor* material : material_descriptors()) {
    std::string row = "| `" + std::string(material->name) + "` | ";
    const std::size_t common = with_common_keys({}).size();
    for (std::size_t i = 0; i + common < material->keys.size(); ++i)
      row += (i ? ", `" : "`") + std::string(material->keys[i].name) + "`";
    row += " | " + std::string(material->formula) + " |";
    INFO(row);
    CHECK(text.find(row) != std::string::npos);
  }
  for (const MaterialKey& key : with_common_keys({})) {
    INFO(key.name);
    CHECK(text.find("`" + std::string(key.name) + "`") != std::string::npos);
  }
}

TEST_CASE("the JSON Schema describes every key in words") {
  const auto check = [](const std::string& where, const Json& object) {
    for (const auto& [key, value] : object["properties"].items()) {
      INFO(where << ": " << key);
      REQUIRE(value.contains("description"));
      CHECK(value["description"].get<std::string>().size() > 8);
    }
  };
  const Json schema = ::schema();
  check("scene", schema);
  for (const auto& [name, definition] : schema["definitions"].items())
    if (definition.contains("properties")) check(name, definition);
}

TEST_CASE("the JSON Schema has the keys that the parser knows, section by section") {
  const Json schema = ::schema();
  std::set<std::string> sections;
  for (const SceneSection& section : scene_sections()) {
    const std::string name(section.name);
    INFO(name);
    sections.insert(name);
    const auto& object = name == "scene" ? schema : schema["definitions"][name];
    CHECK(object["additionalProperties"] == false);
    std::set<std::string> in_schema;
    for (const auto& [key, value] : object["properties"].items()) in_schema.insert(key);
    CHECK(in_schema == std::set<std::string>(section.keys.begin(), section.keys.end()));
  }
  sections.insert("render");
  std::set<std::string> in_schema, in_parser;
  for (const auto& [key, value] : schema["definitions"]["render"]["properties"].items())
    in_schema.insert(key);
  for (const cli::RenderFlag& flag : cli::render_flags())
    if (flag.in_scene) in_parser.insert(flag.name);
  CHECK(in_schema == in_parser);
  for (const auto& [name, definition] : schema["definitions"].items()) {
    INFO(name);
    CHECK(definition.contains("properties") == sections.contains(name));
  }
}
