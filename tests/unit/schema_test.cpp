#include <catch2/catch.hpp>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

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
  for (const auto& [name, definition] : schema["definitions"].items()) {
    INFO(name);
    CHECK(definition.contains("properties") == sections.contains(name));
  }
}
