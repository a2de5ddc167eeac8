// glTF files that are broken: each gets one line that says what, and exit code 2.
#include <catch2/catch.hpp>

#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "gltf_file.h"
#include "run_castray.h"

namespace {

using Json = GltfFile::Json;

struct Case {
  std::string what, file, content, message;
};

/// A file with one square, on node 0, that `change` breaks. Accessors 0 to 3 are positions, normals, texture
/// coordinates and indices.
Case in_json(const std::string& what, const std::function<void(GltfFile&)>& change,
             const std::string& message) {
  GltfFile file;
  file.add_node({{"mesh", file.add_square()}});
  change(file);
  return {what, "t.glb", file.glb(), "t.glb: " + message};
}

/// The same, of one member: `at` is where, "/accessors/0/count".
Case in_member(const std::string& what, const std::string& at, const Json& value,
               const std::string& message) {
  return in_json(
      what, [&](GltfFile& file) { file.json[Json::json_pointer(at)] = value; }, message);
}

Case in_bytes(const std::string& what, const std::function<void(std::string&)>& change,
              const std::string& message) {
  GltfFile file;
  file.add_node({{"mesh", file.add_square()}});
  std::string bytes = file.glb();
  change(bytes);
  return {what, "t.glb", bytes, "t.glb: " + message};
}

Case in_text(const std::string& what, const std::string& text, const std::string& message) {
  return {what, "t.gltf", text, "t.gltf" + message};
}

std::string deep(int levels) {
  const auto n = static_cast<std::size_t>(levels);
  return R"({"asset":{"version":"2.0"},"extras":)" + std::string(n, '[') + std::string(n, ']') + "}";
}

void sparse(GltfFile& file, double index, int count) {
  const int which = file.add_indices<std::uint32_t>({index});
  const int values = file.add_accessor<float>({{0, 0, 0}});
  const auto view = [&](int accessor) {
    return file.json["accessors"][static_cast<std::size_t>(accessor)]["bufferView"];
  };
  file.json["accessors"][0]["sparse"] = {{"count", count},
                                         {"indices", {{"bufferView", view(which)}, {"componentType", 5125}}},
                                         {"values", {{"bufferView", view(values)}}}};
}

void camera(GltfFile& file, const Json& made) { file.add_node({{"camera", file.add("cameras", made)}}); }

std::vector<Case> cases() {
  return {
      in_text("an empty file", "",
              ":1:1: not valid JSON: syntax error while parsing value - unexpected end of "
              "input; expected '[', '{', or a literal"),
      in_text(
          "a syntax error", "{\n \"asset\": {\"version\": \"2.0\"},\n \"nodes\": [,]}",
          ":3:12: not valid JSON: syntax error while parsing value - unexpected ','; expected '[', '{', or a "
          "literal"),
      in_text("no object", "[]", ":1:1: a glTF file is an object in braces"),
      in_text("no version", R"({"asset": {}})",
              ": \"asset\" object not found in .gltf or not an object type"),
      in_text("deep nesting", deep(100), ":1:100: nested deeper than 64 levels"),
      in_text("very deep nesting", deep(100000), ":1:100: nested deeper than 64 levels"),
      in_text("the first version", R"({"asset":{"version":"1.0"},"accessors":{},"meshes":{}})",
              ":1:21: version 1 of glTF; version 2 is read: export the file anew, or convert it"),
      in_text("the first version, unsaid", "{\"accessors\":\n {}}",
              ":2:2: version 1 of glTF; version 2 is read: export the file anew, or convert it"),
      in_text("a version to come", R"({"asset":{"version":"3.1"}})",
              ":1:21: version 3.1 of glTF; version 2 is read: export the file anew, or convert it"),
      in_text("no scene in it", R"({"asset":{"version":"2.0"}})",
              ": no faces, so that the scene has no triangle"),
      in_text(
          "a missing buffer",
          R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":8,"uri":"nowhere.bin"}]})",
          ":1:39: buffers[0]: no such file: nowhere.bin; put it beside the glTF file, or export one .glb"),
      in_text("a buffer without a place", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":8}]})",
              ": 'uri' is missing from non binary glTF file buffer."),
      in_text(
          "a data URI that is too short",
          R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"data:application/octet-stream;base64,AAAA"}]})",
          ": Failed to decode 'uri' : data:application/octet-stream;base64,AAAA in Buffer"),
      in_text("a required extension",
              "{\"asset\":{\"version\":\"2.0\"},\n\"extensionsRequired\": [\"KHR_mesh_quantization\", "
              "\"KHR_odd\"]}",
              ":2:49: the file requires the extension KHR_odd, which is not read"),
      in_text("Draco's compression",
              "{\"asset\":{\"version\":\"2.0\"},\n\"extensionsRequired\": [\"KHR_draco_mesh_compression\"]}",
              ":2:24: the meshes are compressed by KHR_draco_mesh_compression, which is not read; export the "
              "file "
              "without compression"),
      in_bytes(
          "a truncated file", [](std::string& b) { b.resize(b.size() - 4); }, "the file ends at byte "),
      in_bytes(
          "a header alone", [](std::string& b) { b.resize(12); }, "the file is too short for a binary glTF"),
      in_bytes(
          "version 1", [](std::string& b) { b[4] = 1; }, "version 1 of binary glTF; version 2 is read"),
      in_bytes(
          "a chunk beyond the file", [](std::string& b) { b[14] = 1; },
          "the chunk at byte 12 is longer than the file"),
      in_bytes(
          "a chunk that is no JSON", [](std::string& b) { b[16] = 'X'; }, "Invalid glTF binary."),
      in_bytes(
          "a binary chunk that is longer than the file by its header",
          [](std::string& b) {
            const std::size_t json =
                static_cast<unsigned char>(b[12]) + 256u * static_cast<unsigned char>(b[13]);
            b[20 + json] = static_cast<char>(b[20 + json] + 8);
          },
          "the chunk at byte "),
      in_bytes(
          "a buffer longer than its chunk",
          [](std::string& b) {
            const std::string length = R"("buffers":[{"byteLength":)";
            b[b.find(length) + length.size()] = '9';
          },
          "Invalid `byteLength'. Must be equal or less than binary size: `byteLength' = "),
      in_member("a buffer view beyond its buffer", "/bufferViews/0/byteLength", 100000,
                "bufferViews[0]: bytes 0 .. 100000 are not all in buffers[0], which has "),
      in_member("a buffer view of no buffer", "/bufferViews/0/buffer", 3,
                "bufferViews[0]: buffers[3] is out of range: valid are 0 .. 0"),
      in_member("an odd stride", "/bufferViews/0/byteStride", 6, "Invalid `byteStride' value."),
      in_member("a stride below the element's size", "/bufferViews/0/byteStride", 4,
                "accessors[0]: elements of 12 bytes every 4 bytes overlap"),
      in_member("an accessor beyond its view", "/accessors/0/count", 5,
                "accessors[0]: 5 elements of 12 bytes do not fit in bufferViews[0], which has 48 bytes"),
      in_member("an accessor of 2^60 elements", "/accessors/0/count", 1ull << 60,
                "accessors[0]: 1152921504606846976 elements of 12 bytes do not fit in bufferViews[0]"),
      in_member("2^60 zeros", "/accessors/0",
                {{"count", 1ull << 60}, {"componentType", 5126}, {"type", "VEC3"}},
                "accessors[0]: 1152921504606846976 elements without a bufferView"),
      in_member("an offset beyond the view", "/accessors/0/byteOffset", 1000,
                "accessors[0]: 4 elements of 12 bytes do not fit in bufferViews[0]"),
      in_member("an accessor of no view", "/accessors/0/bufferView", 77,
                "accessors[0]: bufferViews[77] is out of range: valid are 0 .. 3"),
      in_member("an unknown component type", "/accessors/0/componentType", 1,
                "Invalid `componentType` in accessor."),
      in_member("positions of doubles", "/accessors/0/componentType", 5130,
                "accessors[0]: of a component type that glTF does not have"),
      in_member("an unknown type of accessor", "/accessors/0/type", "VEC9",
                "Unsupported `type` for accessor object."),
      in_member("positions in pairs", "/accessors/0/type", "VEC2",
                "accessors[0]: its elements have 2 numbers; meshes[0] needs 3"),
      in_member("no accessor for positions", "/meshes/0/primitives/0/attributes/POSITION", 42,
                "meshes[0]: accessors[42] is out of range: valid are 0 .. 3"),
      in_member("no positions", "/meshes/0/primitives/0/attributes", {{"NORMAL", 1}},
                "meshes[0]: a primitive without vertices: it needs POSITION"),
      in_member("fewer normals than positions", "/accessors/1/count", 3,
                "meshes[0]: NORMAL of 3 vertices, POSITION of 4"),
      in_member("indices of floats", "/meshes/0/primitives/0/indices", 0,
                "accessors[0]: indices must be unsigned whole numbers"),
      in_member("an unknown mode", "/meshes/0/primitives/0/mode", 9, "meshes[0]: unknown mode 9"),
      in_member("no such material", "/meshes/0/primitives/0/material", 1,
                "meshes[0]: materials[1] is out of range: the file has none"),
      in_json(
          "an index out of range",
          [](GltfFile& file) {
            file.json["meshes"][0]["primitives"][0]["indices"] = file.add_indices<std::uint8_t>({0, 1, 4});
          },
          "meshes[0]: vertex index 4 is out of range: valid are 0 .. 3"),
      in_json(
          "a sparse index out of range", [](GltfFile& file) { sparse(file, 4, 1); },
          "accessors[0]: sparse index 4 is out of range: valid are 0 .. 3"),
      in_json(
          "more sparse elements than elements", [](GltfFile& file) { sparse(file, 0, 9); },
          "accessors[0]: its sparse elements are more than it has, or begin below 0"),
      in_json(
          "a negative count of sparse elements", [](GltfFile& file) { sparse(file, 0, -9); },
          "accessors[0]: its sparse elements are more than it has, or begin below 0"),
      in_member("a node that is its own child", "/nodes/0/children", {0},
                "nodes[0]: has two parents, or is its own descendant; nodes must be a tree"),
      in_json(
          "a node of two parents",
          [](GltfFile& file) {
            const int shared = file.add("nodes", {{"mesh", 0}});
            file.add_node({{"children", {shared}}});
            file.add_node({{"children", {shared}}});
          },
          "nodes[1]: has two parents, or is its own descendant; nodes must be a tree"),
      in_member("no such child", "/nodes/0/children", {9},
                "nodes[0]: nodes[9] is out of range: valid are 0 .. 0"),
      in_member("a child below 0", "/nodes/0/children", {-1},
                "nodes[0]: nodes[-1] is out of range: valid are 0 .. 0"),
      in_member("no such mesh", "/nodes/0/mesh", 8, "nodes[0]: meshes[8] is out of range: valid are 0 .. 0"),
      in_member("no such scene", "/scene", 5, "scene 5 is out of range: valid are 0 .. 0"),
      in_member("a matrix of 3 numbers", "/nodes/0/matrix", {1, 0, 0},
                "nodes[0]: matrix has 3 numbers, not 16"),
      in_member("a scale of 2 numbers", "/nodes/0/scale", {1, 0}, "nodes[0]: scale has 2 numbers, not 3"),
      in_json(
          "a camera of no angle",
          [](GltfFile& file) {
            camera(file, {{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 1}}}});
          },
          "cameras[0]: yfov must be between 0 and pi, not 0"),
      in_json(
          "a camera of no height",
          [](GltfFile& file) {
            camera(file, {{"type", "orthographic"},
                          {"orthographic", {{"xmag", 1}, {"ymag", 0}, {"znear", 1}, {"zfar", 2}}}});
          },
          "cameras[0]: ymag must not be 0"),
      in_json(
          "no such light",
          [](GltfFile& file) { file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; },
          "nodes[0]: lights[0] is out of range: the file has none"),
  };
}

}  // namespace

TEST_CASE("a broken glTF file is one line and exit code 2") {
  const TemporaryFolder folder;
  for (const Case& broken : cases()) {
    CAPTURE(broken.what);
    std::ofstream(folder / broken.file, std::ios::binary) << broken.content;
    const RunResult result = run_castray({"info", broken.file}, folder.path());
    CHECK(result.exit_code == 2);
    CHECK(result.out.empty());
    CHECK(result.error_lines() == 1);
    CHECK_THAT(result.err, Catch::Matchers::StartsWith("castray: error: " + broken.message));
  }
}
