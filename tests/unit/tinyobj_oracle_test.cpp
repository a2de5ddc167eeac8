#include <tiny_obj_loader.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "core/sequences.h"
#include "scene/mtl_file.h"
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

/// Whether all three normals of a triangle, in single precision, oppose its winding: such are turned round.
bool opposes_its_normals(const tinyobj::attrib_t& attributes, const tinyobj::index_t corners[3]) {
  const auto vector = [](const std::vector<float>& values, int index) {
    const float* v = &values[3 * static_cast<std::size_t>(index)];
    return Vec3d{v[0], v[1], v[2]};
  };
  Vec3d p[3];
  for (int i = 0; i < 3; ++i) p[i] = vector(attributes.vertices, corners[i].vertex_index);
  const Vec3d winding = cross(p[1] - p[0], p[2] - p[0]);
  for (int i = 0; i < 3; ++i)
    if (corners[i].normal_index < 0 || dot(vector(attributes.normals, corners[i].normal_index), winding) >= 0)
      return false;
  return true;
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
  WarningList warnings;
  const Mesh mesh = read_obj(folder / "o.obj", warnings).mesh;

  REQUIRE(attributes.vertices.size() == 3 * mesh.positions.size());
  bool same = true;
  for (std::size_t i = 0; i < attributes.vertices.size(); ++i)
    same &= attributes.vertices[i] == Approx(mesh.positions[i / 3][static_cast<int>(i % 3)]);
  CHECK(same);
  REQUIRE(shapes.size() == 1);
  REQUIRE(shapes[0].mesh.indices.size() == 3 * mesh.triangles.size());
  std::size_t turned = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const bool turns = opposes_its_normals(attributes, &shapes[0].mesh.indices[3 * t]);
    turned += turns;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t ours = 3 * t + (turns ? (3 - i) % 3 : i);
      const tinyobj::index_t& index = shapes[0].mesh.indices[3 * t + i];
      same &= static_cast<std::uint32_t>(index.vertex_index) == mesh.triangles[ours / 3][ours % 3];
      same &= static_cast<std::uint32_t>(index.texcoord_index) == index_or_none(mesh.triangle_uvs, ours);
      same &= static_cast<std::uint32_t>(index.normal_index) == index_or_none(mesh.triangle_normals, ours);
    }
  }
  CHECK(turned > 100);
  CHECK(same);
}

TEST_CASE("MTL files say what tinyobjloader reads of them") {
  // tinyobjloader wants all three numbers of -s and -o.
  std::uint32_t random = 5;
  const auto below = [&](std::uint32_t n) { return (random = hash32(random + 1)) % n; };
  const auto number = [&] { return std::to_string(below(1001) * 1e-3); };
  const auto color = [&] { return number() + " " + number() + " " + number() + "\n"; };
  std::string text;
  for (int m = 0; m < 300; ++m) {
    text += "newmtl m " + std::to_string(m) + "\n";
    if (below(2)) text += "Kd " + color();
    if (below(2)) text += "Ks " + color();
    if (below(2)) text += "Ke " + color();
    if (below(2)) text += "Ns " + number() + "\n";
    if (below(2)) text += "Ni " + number() + "\n";
    if (below(2)) text += "d " + number() + "\n";
    if (below(2)) text += "Pr " + number() + "\nPm " + number() + "\n";
    if (below(2)) text += "illum " + std::to_string(below(10)) + "\n";
    if (below(2)) text += "map_Kd -s 2 " + number() + " 1 -o " + number() + " 3 0 -clamp on my wood.png\n";
    if (below(2)) text += "map_bump -bm " + number() + " bumps.png\n";
    if (below(2)) text += "norm n.png\n";
    if (below(2)) text += "map_d -imfchan m leaf.png\n";
  }
  std::map<std::string, int> names;
  std::vector<tinyobj::material_t> theirs;
  std::istringstream stream(text);
  std::string warning, error;
  tinyobj::LoadMtl(&names, &theirs, &stream, &warning, &error);
  WarningList warnings;
  const MtlFile ours = parse_mtl(text, "o.mtl", warnings);
  CHECK(warnings.take().empty());
  REQUIRE(ours.materials.size() == theirs.size());
  bool same = true;
  const auto same_color = [&](const std::optional<Vec3d>& a, const tinyobj::real_t b[3]) {
    for (int i = 0; i < 3; ++i) same &= !a || (*a)[i] == Approx(b[i]);
  };
  const auto same_number = [&](const std::optional<double>& a, double b) { same &= !a || *a == Approx(b); };
  const auto same_file = [&](const std::optional<TextureStatement>& a, const std::string& b) {
    same &= (a ? a->file : "") == b;
  };
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const MtlMaterial& a = ours.materials[i];
    const tinyobj::material_t& b = theirs[i];
    same &= a.name == b.name;
    same_color(a.kd, b.diffuse);
    same_color(a.ks, b.specular);
    same_color(a.ke, b.emission);
    same_number(a.ns, b.shininess);
    same_number(a.ni, b.ior);
    same_number(a.dissolve, b.dissolve);
    same_number(a.roughness, b.roughness);
    same_number(a.metallic, b.metallic);
    same &= a.illum.value_or(0) == b.illum;
    same_file(a.map(MtlMap::kd), b.diffuse_texname);
    same_file(a.map(MtlMap::bump), b.bump_texname);
    same_file(a.map(MtlMap::normal), b.normal_texname);
    same_file(a.map(MtlMap::dissolve), b.alpha_texname);
    if (const auto& map = a.map(MtlMap::kd))
      for (std::size_t k = 0; k < 2; ++k) {
        same &= map->scale[k] == Approx(b.diffuse_texopt.scale[k]);
        same &= map->offset[k] == Approx(b.diffuse_texopt.origin_offset[k]);
        same &= map->clamp == b.diffuse_texopt.clamp;
      }
    if (const auto& map = a.map(MtlMap::bump)) same &= map->bump == Approx(b.bump_texopt.bump_multiplier);
    if (const auto& map = a.map(MtlMap::dissolve)) same &= map->channel == b.alpha_texopt.imfchan;
  }
  CHECK(same);
}
