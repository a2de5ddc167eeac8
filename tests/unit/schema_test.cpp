#include <catch2/catch.hpp>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "cli/render_flags.h"
#include "scene/scene_file.h"

using namespace castray;

TEST_CASE("the JSON Schema has the keys that the parser knows, section by section") {
  const auto schema =
      nlohmann::json::parse(std::ifstream(std::string(CASTRAY_ROOT) + "/scenes/castray.schema.json"));
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
