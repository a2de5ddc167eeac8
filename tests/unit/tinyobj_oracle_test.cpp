#include <tiny_obj_loader.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>
#include <string>

#include "core/sequences.h"
#include "scene/obj_file.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// Triangles with every kind of corner, indices from the front and from the back.
std::string various_triangles() {
  std::uint32_t random = 1;
  const auto below = [&](std::uint32_t n) { return (random = hash32(random + 1)) % n; };
  std::ostringstream obj;
  obj.precision(9);
  std::uint32_t vertices = 0, uvs = 0, normals = 0;
  for (int face = 0; face < 2000; ++face) {
    for (int i = 0; i < 3; ++i) {
      obj << "v " << below(2000) * 0.37 - 300 << ' ' << below(1000) * 1e-7 << ' ' << below(100000) * 1e3
          << '\n';
      obj << "vt " << below(1000) * 1e-3 << ' ' << below(1000) * 1e-3 << '\n';
      obj << "vn " << below(100) + 1 << ' ' << below(100) << ' ' << below(100) << '\n';
    }
    vertices += 3, uvs += 3, normals += 3;
    obj << "f";
    const std::uint32_t kind = below(4);
    for (int i = 0; i < 3; ++i) {
      const auto index = [&](std::uint32_t count) {
        const auto back = static_cast<long>(below(count)) + 1;
        return std::to_string(below(2) ? -back : static_cast<long>(count) - back + 1);
      };
      obj << ' ' << index(vertices);
      if (kind == 1) obj << '/' << index(uvs);
      if (kind == 2) obj << "//" << index(normals);
      if (kind == 3) obj << '/' << index(uvs) << '/' << index(normals);
    }
    obj << '\n';
  }
  return obj.str();
}

std::uint32_t index_or_none(const std::vector<Index3>& triangles, std::size_t corner) {
  return triangles.empty() ? Scene::no_index : triangles[corner / 3][corner % 3];
}

}  // namespace

TEST_CASE("OBJ files are read as tinyobjloader reads them") {
  const std::string text = various_triangles();
  std::istringstream stream(text);
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  REQUIRE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &stream));

  const TemporaryFolder folder;
  std::ofstream(folder / "o.obj") << text;
  SceneBuilder builder;
  const Mesh mesh = read_obj(folder / "o.obj", {}, builder);

  REQUIRE(attributes.vertices.size() == 3 * mesh.positions.size());
  bool same = true;
  for (std::size_t i = 0; i < attributes.vertices.size(); ++i)
    same &= attributes.vertices[i] == Approx(mesh.positions[i / 3][static_cast<int>(i % 3)]);
  CHECK(same);
  REQUIRE(shapes.size() == 1);
  REQUIRE(shapes[0].mesh.indices.size() == 3 * mesh.triangles.size());
  for (std::size_t i = 0; i < shapes[0].mesh.indices.size(); ++i) {
    const tinyobj::index_t& index = shapes[0].mesh.indices[i];
    same &= static_cast<std::uint32_t>(index.vertex_index) == mesh.triangles[i / 3][i % 3];
    same &= static_cast<std::uint32_t>(index.texcoord_index) == index_or_none(mesh.triangle_uvs, i);
    same &= static_cast<std::uint32_t>(index.normal_index) == index_or_none(mesh.triangle_normals, i);
  }
  CHECK(same);
}
