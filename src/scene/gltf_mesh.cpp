#include "scene/gltf_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scene/gltf_accessor.h"
#include "scene/mesh_faces.h"

namespace castray {

namespace {

constexpr std::string_view meshes = "meshes";

class PrimitiveReader {
 public:
  PrimitiveReader(const GltfDocument& document, const tinygltf::Primitive& primitive, const GltfUvs& uvs,
                  std::size_t mesh, WarningList& warnings)
      : document_(document), primitive_(primitive), uvs_(uvs), number_(mesh), warnings_(warnings) {}

  Mesh read() {
    const int mode = primitive_.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive_.mode;
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN) fail(fmt::format("unknown mode {}", mode));
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      warn("points and lines are left out");
      return {};
    }
    if (primitive_.attributes.contains("JOINTS_0")) warn("bones are left out: the mesh has its pose at rest");
    if (!primitive_.targets.empty()) warn("morph targets are left out");
    read_attributes();
    add_triangles(mode, read_order());
    if (!mesh_.colors.empty()) mesh_.triangle_colors = mesh_.triangles;
    faces_.warn(warnings_, fmt::format("{}[{}]: ", meshes, number_));
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { document_.fail(meshes, number_, what); }
  void warn(const std::string& what) const { document_.warn(warnings_, meshes, number_, what); }

  /// The numbers of an attribute; empty where the primitive has none of that name.
  std::vector<float> attribute(const std::string& name, int components) const {
    const auto found = primitive_.attributes.find(name);
    if (found == primitive_.attributes.end()) return {};
    std::vector<float> numbers = read_floats(document_, found->second, components, meshes, number_);
    const std::size_t count = numbers.size() / static_cast<std::size_t>(components);
    if (!mesh_.positions.empty() && count != mesh_.positions.size())
      fail(fmt::format("{} of {} vertices, POSITION of {}", name, count, mesh_.positions.size()));
    return numbers;
  }

  void read_attributes() {
    const std::vector<float> positions = attribute("POSITION", 3);
    if (positions.empty()) fail("a primitive without vertices: it needs POSITION");
    if (positions.size() / 3 >= Scene::no_index) fail("more than 2^32 - 2 vertices");
    mesh_.positions.reserve(positions.size() / 3);
    for (std::size_t i = 0; i < positions.size(); i += 3)
      mesh_.positions.push_back(Vec3d{positions[i], positions[i + 1], positions[i + 2]});
    const std::vector<float> normals = attribute("NORMAL", 3);
    for (std::size_t i = 0; i < normals.size(); i += 3)
      mesh_.normals.push_back(stored_normal(Vec3d{normals[i], normals[i + 1], normals[i + 2]}));
    read_uvs();
    read_colors();
  }

  /// Turned where the material's images are; castray's v grows upwards.
  void read_uvs() {
    const std::vector<float> uvs = attribute(fmt::format("TEXCOORD_{}", uvs_.set), 2);
    const UvTransform& t = uvs_.turn;
    for (std::size_t i = 0; i < uvs.size(); i += 2) {
      const double u = uvs[i], v = uvs[i + 1];
      const double at_u = t.u[0] * u + t.u[1] * v + t.u[2], at_v = 1 - (t.v[0] * u + t.v[1] * v + t.v[2]);
      const bool finite = std::isfinite(at_u) && std::isfinite(at_v);
      mesh_.uvs.push_back({finite ? static_cast<float>(at_u) : 0.f, finite ? static_cast<float>(at_v) : 0.f});
    }
  }

  /// They are linear.
  void read_colors() {
    const auto found = primitive_.attributes.find("COLOR_0");
    if (found == primitive_.attributes.end()) return;
    const auto components =
        static_cast<std::size_t>(components_of(document_, found->second, meshes, number_) == 4 ? 4 : 3);
    const std::vector<float> colors = attribute("COLOR_0", static_cast<int>(components));
    bool has_alpha = false;
    for (std::size_t i = 0; i < colors.size(); i += components) {
      const auto unit = [&](std::size_t c) {
        return std::isfinite(colors[i + c]) ? std::clamp(colors[i + c], 0.f, 1.f) : 0.f;
      };
      mesh_.colors.push_back({unit(0), unit(1), unit(2)});
      has_alpha = has_alpha || (components == 4 && unit(3) < 1);
    }
    if (has_alpha) warn("the alpha of vertex colours is left out");
  }

  /// The vertices in the order in which they are used.
  std::vector<std::uint32_t> read_order() const {
    const std::size_t count = mesh_.positions.size();
    if (primitive_.indices < 0) {
      std::vector<std::uint32_t> order(count);
      std::iota(order.begin(), order.end(), 0u);
      return order;
    }
    std::vector<std::uint32_t> order = read_indices(document_, primitive_.indices, meshes, number_);
    if (const auto bad = std::ranges::find_if(order, [count](std::uint32_t i) { return i >= count; });
        bad != order.end())
      fail(fmt::format("vertex index {} is out of range: valid are 0 .. {}", *bad, count - 1));
    return order;
  }

  void add_triangles(int mode, const std::vector<std::uint32_t>& order) {
    const std::size_t count = order.size();
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      if (count % 3 != 0) warn("the vertices behind the last whole triangle are left out");
      mesh_.triangles.reserve(count / 3);
      for (std::size_t i = 0; i + 2 < count; i += 3) add(order[i], order[i + 1], order[i + 2]);
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      for (std::size_t i = 0; i + 2 < count; ++i)  // every second one is wound the other way
        add(order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]);
    } else {
      for (std::size_t i = 0; i + 2 < count; ++i) add(order[i + 1], order[i + 2], order[0]);
    }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Corner corners[] = {corner(a), corner(b), corner(c)};
    faces_.add(corners, 0);
  }

  Corner corner(std::uint32_t i) const {
    return {i, mesh_.uvs.empty() ? Scene::no_index : i, mesh_.normals.empty() ? Scene::no_index : i};
  }

  const GltfDocument& document_;
  const tinygltf::Primitive& primitive_;
  const GltfUvs& uvs_;
  std::size_t number_;
  WarningList& warnings_;
  Mesh mesh_;
  MeshFaces faces_{mesh_, [this] { return document_.place(meshes, number_); }};
};

}  // namespace

Mesh read_primitive(const GltfDocument& document, const tinygltf::Primitive& primitive, const GltfUvs& uvs,
                    std::size_t mesh, WarningList& warnings) {
  return PrimitiveReader(document, primitive, uvs, mesh, warnings).read();
}

}  // namespace castray
