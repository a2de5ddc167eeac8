#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base64.h"
#include "small_files.h"

/// A glTF file put together by a test: buffer views and accessors are packed into one buffer, the rest is
/// JSON.
class GltfFile {
 public:
  using Json = nlohmann::ordered_json;
  using Points = std::vector<std::vector<double>>;

  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", Json::array()}}}}};
  std::string bytes;  ///< of the buffer

  /// Adds `element` to the file's `list`; returns its number.
  int add(const char* list, Json element) {
    json[list].push_back(std::move(element));
    return static_cast<int>(json[list].size()) - 1;
  }

  int add_view(const std::string& data, Json more = Json::object()) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    more["buffer"] = 0, more["byteOffset"] = bytes.size(), more["byteLength"] = data.size();
    bytes += data;
    return add("bufferViews", std::move(more));
  }

  /// An accessor of `elements` numbers of type T, with the members of `more`.
  template <class T>
  int add_accessor(const Points& elements, Json more = Json::object()) {
    constexpr const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    more["bufferView"] = add_view(packed<T>(elements)), more["count"] = elements.size();
    more["componentType"] = component_type(T()), more["type"] = types[elements.front().size()];
    return add("accessors", std::move(more));
  }

  template <class T>
  int add_indices(const std::vector<double>& indices) {
    Points elements;
    for (const double i : indices) elements.push_back({i});
    return add_accessor<T>(elements);
  }

  template <class T>
  static std::string packed(const Points& elements) {
    std::string data;
    for (const auto& element : elements)
      for (const double number : element) {
        const T value = static_cast<T>(number);
        data.append(reinterpret_cast<const char*>(&value), sizeof(T));
      }
    return data;
  }

  /// A node of the scene.
  int add_node(Json node) {
    const int index = add("nodes", std::move(node));
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  /// An image within the buffer, and its texture.
  int add_texture(const std::string& png, Json more = Json::object()) {
    more["source"] = add("images", {{"bufferView", add_view(png)}, {"mimeType", "image/png"}});
    return add("textures", std::move(more));
  }

  /// A square in the plane z = 0 from -1 to 1 that faces +z, with the whole of an image on it.
  Json square(int material = -1) {
    Json primitive = {{"attributes",
                       {{"POSITION", add_accessor<float>({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}})},
                        {"NORMAL", add_accessor<float>({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}})},
                        {"TEXCOORD_0", add_accessor<float>({{0, 1}, {1, 1}, {1, 0}, {0, 0}})}}},
                      {"indices", add_indices<std::uint16_t>({0, 1, 2, 0, 2, 3})}};
    if (material >= 0) primitive["material"] = material;
    return primitive;
  }
  int add_square(int material = -1) { return add_mesh(square(material)); }
  int add_mesh(Json primitive) { return add("meshes", {{"primitives", {std::move(primitive)}}}); }

  int add_sphere(int material, int rows = 16) {
    Points points, indices;
    const int columns = 2 * rows, width = columns + 1;
    for (int row = 0; row <= rows; ++row)
      for (int column = 0; column <= columns; ++column) {
        const double down = std::numbers::pi * row / rows, turn = std::numbers::pi * column / rows;
        points.push_back({std::sin(down) * std::cos(turn), std::cos(down), -std::sin(down) * std::sin(turn)});
      }
    std::vector<double> order;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const double a = row * width + column, below = a + width;
        if (row > 0) order.insert(order.end(), {a, below, a + 1});
        if (row < rows - 1) order.insert(order.end(), {a + 1, below, below + 1});
      }
    const int at = add_accessor<float>(points);
    return add_mesh({{"attributes", {{"POSITION", at}, {"NORMAL", at}}},
                     {"indices", add_indices<std::uint16_t>(order)},
                     {"material", material}});
  }

  /// A camera at (0,0,z) that sees an upright square of half side `half` around the origin.
  void add_orthographic(double half, double z = 5) {
    const int camera =
        add("cameras", {{"type", "orthographic"},
                        {"orthographic", {{"xmag", half}, {"ymag", half}, {"znear", 0.1}, {"zfar", 100}}}});
    add_node({{"camera", camera}, {"translation", {0, 0, z}}});
  }

  /// With the buffer as a data URI.
  std::string gltf() const {
    Json all = json;
    all["buffers"] = {{{"byteLength", bytes.size()},
                       {"uri", "data:application/octet-stream;base64," + castray::base64(bytes)}}};
    return all.dump(1);
  }

  std::string glb() const {
    Json all = json;
    if (!bytes.empty()) all["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = all.dump(), data = bytes;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    data.resize((data.size() + 3) / 4 * 4);
    std::string chunks = chunk("JSON", text);
    if (!data.empty()) chunks += chunk(std::string("BIN\0", 4), data);
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
  }

  static std::string word(std::size_t value) { return little_endian(static_cast<std::uint32_t>(value), 4); }
  static std::string chunk(const std::string& type, const std::string& data) {
    return word(data.size()) + type + data;
  }

 private:
  static int component_type(std::int8_t) { return 5120; }
  static int component_type(std::uint8_t) { return 5121; }
  static int component_type(std::int16_t) { return 5122; }
  static int component_type(std::uint16_t) { return 5123; }
  static int component_type(std::uint32_t) { return 5125; }
  static int component_type(float) { return 5126; }
};
