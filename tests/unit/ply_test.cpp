// PLY files, ASCII and binary, made by the tests themselves.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>

#include "castray/scene.h"
#include "scene/ply_file.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// Writes numbers as PLY's formats do.
class Writer {
 public:
  explicit Writer(std::string format) : format_(std::move(format)) {}

  template <class T>
  Writer& add(T value) {
    if (format_ == "ascii") {
      bytes_ += std::to_string(value) + " ";
      return *this;
    }
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (format_ == "binary_big_endian") std::reverse(raw, raw + sizeof(T));
    bytes_.append(raw, sizeof(T));
    return *this;
  }
  void end_line() {
    if (format_ == "ascii") bytes_ += "\n";
  }
  std::string file(const std::string& elements, const std::string& line_end = "\n") const {
    std::string header =
        "ply\nformat " + format_ + " 1.0\ncomment of a test\\\nobj_info none\n" + elements + "end_header\n";
    for (std::size_t at = 0; line_end != "\n" && (at = header.find('\n', at)) != header.npos;
         at += line_end.size())
      header.replace(at, 1, line_end);
    return header + bytes_;
  }

 private:
  std::string format_, bytes_;
};

const std::vector<std::string> formats{"ascii", "binary_little_endian", "binary_big_endian"};

ObjFile read(const std::string& bytes, WarningList& warnings) { return parse_ply(bytes, "t.ply", warnings); }
ObjFile read(const std::string& bytes) {
  WarningList warnings;
  ObjFile file = read(bytes, warnings);
  CHECK(warnings.take().empty());
  return file;
}

/// The unit square, with all that vertices may have, as one quad.
std::string square(const std::string& format, const std::string& line_end = "\n") {
  Writer w(format);
  for (int i = 0; i < 4; ++i) {
    const bool right = i == 1 || i == 2, up = i >= 2;
    w.add(right ? 1.0 : 0.0).add(up ? 1.f : 0.f).add(0.f).add(short{7});
    w.add(0.f).add(0.f).add(2.f).add(right ? 0.75f : 0.25f).add(up ? 1.f : 0.f);
    w.add(std::uint8_t(right ? 255 : 0)).add(std::uint8_t{188}).add(std::uint8_t{0}).add(std::uint8_t{9});
    w.end_line();
  }
  w.add(std::uint8_t{2}).add(5).add(6).end_line();
  w.add(std::uint8_t{1}).add(std::uint8_t{4}).add(0).add(1).add(2).add(3).end_line();
  return w.file(
      "element vertex 4\nproperty double x\nproperty float32 y\nproperty float z\nproperty int16 quality\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "property uchar red\nproperty uint8 green\nproperty uchar blue\nproperty uchar alpha\n"
      "element edge 1\nproperty list uchar int ends\n"
      "element face 1\nproperty uchar flags\nproperty list uchar int vertex_indices\n",
      line_end);
}

/// Three vertices and what follows them.
std::string triangle(const std::string& elements, const std::string& rest) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
         elements + "end_header\n0 0 0\n1 0 0\n0 1 0\n" + rest;
}
const std::string face = "element face 1\nproperty list uchar int vertex_index\n";

std::string error_of(const std::string& bytes) {
  try {
    WarningList warnings;
    read(bytes, warnings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("PLY: ASCII and binary of both byte orders hold the same") {
  for (const std::string& format : formats)
    for (const std::string line_end : {"\n", "\r\n", "\r"}) {
      CAPTURE(format, line_end.size());
      const Mesh mesh = read(square(format, line_end)).mesh;
      REQUIRE(mesh.positions.size() == 4);
      CHECK(mesh.positions[2] == Vec3d{1, 1, 0});
      CHECK(mesh.triangles == std::vector<Index3>{{0, 1, 2}, {0, 2, 3}});
      CHECK(mesh.normals[3] == Vec3f{0, 0, 1});
      CHECK(mesh.triangle_normals == mesh.triangles);
      CHECK(mesh.uvs[1] == std::array<float, 2>{0.75f, 0});
      CHECK(mesh.triangle_uvs == mesh.triangles);
      CHECK(mesh.triangle_colors == mesh.triangles);
      CHECK(mesh.colors[1].x == Approx(1));
      CHECK(mesh.colors[0].x == 0);
      CHECK(mesh.colors[0].y == Approx(0.5).margin(0.004));  // 188 by the curve of sRGB
    }
}

TEST_CASE("PLY: colours of faces count where vertices have none") {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string two = "element face 2\nproperty list uchar int vertex_index\n" + colors;
  const Mesh mesh = read(triangle(two, "3 0 1 2 255 0 0\n3 2 1 0 0 255 255\n")).mesh;
  CHECK(mesh.colors == std::vector<Vec3f>{{1, 0, 0}, {0, 1, 1}});
  CHECK(mesh.triangle_colors == std::vector<Index3>{{0, 0, 0}, {1, 1, 1}});
}

TEST_CASE("PLY: faces may stand in front of their vertices") {
  const std::string points =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n";
  for (const std::string& format : formats) {
    Writer w(format);
    w.add(std::uint8_t{3}).add(0).add(1).add(2).end_line();
    for (int i = 0; i < 3; ++i) {
      w.add(i == 1 ? 1.f : 0.f).add(i == 2 ? 1.f : 0.f).add(0.f).add(0.f).add(0.f).add(1.f);
      w.end_line();
    }
    const Mesh mesh = read(w.file("element face 1\nproperty list uchar int vertex_index\n" + points)).mesh;
    CHECK(mesh.triangles == std::vector<Index3>{{0, 1, 2}});
    CHECK(mesh.triangle_normals == mesh.triangles);
    CHECK(mesh.positions == std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  }
}

TEST_CASE("PLY: a remark without \"comment\" in the header is passed over") {
  std::string remark = triangle(face, "3 0 1 2\n");
  remark.insert(remark.find("element"), "Created by Blender3D 247 - www.blender.org, source file: \n");
  WarningList warnings;
  CHECK(read(remark, warnings).mesh.triangles.size() == 1);
  const std::vector<SceneWarning> told = warnings.take();
  REQUIRE(told.size() == 1);
  CHECK(told[0].text() == "t.ply:3: unknown word 'Created' in the header; its line is left out");
}

TEST_CASE("PLY: a mesh alone, of a scene file, with colours or a material") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.ply", std::ios::binary) << square("binary_big_endian");
  const Scene alone = load_scene(folder / "t.ply");
  CHECK(alone.triangles.size() == 2);
  CHECK(alone.material_of(0).vertex_colors);
  std::ofstream(folder / "s.json")
      << R"({ "materials": { "red": { "type": "diffuse", "kd": [1, 0, 0] } }, "meshes": [
      { "ply": "t.ply", "material": "red" }, { "ply": "t.ply", "transform": [ { "translate": [3, 0, 0] } ] } ] })";
  const Scene scene = load_scene(folder / "s.json");
  CHECK(scene.triangles.size() == 4);
  CHECK(scene.material_of(0).name == "red");
  CHECK(scene.material_of(2).vertex_colors);
}

TEST_CASE("PLY: polygons are cut, strips are turned, corners have texture coordinates of their own") {
  CHECK(read(triangle(face, "3 2 0 1\n")).mesh.triangles == std::vector<Index3>{{2, 0, 1}});
  const std::string strip =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 1 1 0\n8 0 1 "
      "2 3 -1 3 2 1\n";
  CHECK(read(strip).mesh.triangles == std::vector<Index3>{{0, 1, 2}, {1, 3, 2}, {3, 2, 1}});
  const std::string wedge = face + "property list uchar float texcoord\n";
  const Mesh mapped = read(triangle(wedge, "3 0 1 2 6 .1 .2 .3 .4 .5 .6\n")).mesh;
  CHECK(mapped.uvs[mapped.triangle_uvs[0][2]] == std::array<float, 2>{0.5f, 0.6f});
  // An L of six corners: its area is that of its triangles.
  std::string corners;
  for (const char* corner : {"0 0 0", "2 0 0", "2 1 0", "1 1 0", "1 2 0", "0 2 0"})
    corners += std::string(corner) + "\n";
  const Mesh concave =
      read("ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n" +
           face + "end_header\n" + corners + "6 0 1 2 3 4 5\n")
          .mesh;
  double area = 0;
  for (const Index3& t : concave.triangles)
    area += cross(concave.positions[t[1]] - concave.positions[t[0]],
                  concave.positions[t[2]] - concave.positions[t[0]])
                .z /
            2;
  CHECK(area == Approx(3));
}

TEST_CASE("PLY: what is odd is told once and left out") {
  const auto told = [](const std::string& bytes) {
    WarningList warnings;
    read(bytes, warnings);
    std::string all;
    for (const SceneWarning& warning : warnings.take()) all += warning.message + "\n";
    return all;
  };
  CHECK(told(triangle("element face 2\nproperty list uchar int vertex_index\n", "2 0 1\n1 0\n")) ==
        "a face of fewer than 3 corners is left out\n");
  CHECK(told("ply\ncomment TextureFile a.png\n" + triangle(face, "3 0 1 2\n").substr(4)) ==
        "the image of 'comment TextureFile' is not read: give the mesh a material\n");
  const std::string against =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty float nx\n"
      "property float ny\nproperty float nz\n" +
      face + "end_header\n0 0 0 0 0 -1\n1 0 0 0 0 -1\n0 1 0 0 0 -1\n3 0 1 2\n";
  CHECK(told(against) ==
        "a triangle's three normals oppose the order of its corners, which is turned round\n");
}

TEST_CASE("PLY: what is broken is named with its line or byte") {
  CHECK(error_of("solid x\n") == "t.ply:1: not a PLY file: its first line is not 'ply'");
  CHECK(error_of("ply\nformat ascii 1.0\n") == "t.ply:3: the header has no line 'end_header'");
  CHECK(error_of("ply\nend_header\n") == "t.ply:2: the header has no line 'format'");
  CHECK(error_of("ply\nformat binary 1.0\n") ==
        "t.ply:2: unknown format 'binary'; known: ascii, binary_little_endian, binary_big_endian");
  CHECK(error_of("ply\nproperty float x\n") == "t.ply:2: a property in front of the first element");
  CHECK(error_of("ply\nelement vertex 1\nproperty half x\n") == "t.ply:3: unknown type 'half' of a property");
  CHECK(error_of("ply\nelement vertex -1\n") == "t.ply:2: '-1' is not a number of elements");
  CHECK(error_of("ply\nelement f 1\nproperty list float int a\n") ==
        "t.ply:3: the length of a list is a whole number");
  CHECK(error_of("ply\nelments\n") ==
        "t.ply:2: unknown word 'elments' in the header; did you mean 'element'?");
  CHECK(error_of(triangle(face, "3 0 1 3\n")) ==
        "t.ply:13: vertex index 3 is out of range: valid are 0 .. 2");
  CHECK(error_of(triangle(face, "3 0 1 -1\n")) ==
        "t.ply:13: vertex index -1 is out of range: valid are 0 .. 2");
  CHECK(error_of(triangle(face, "3 0 1 1.5\n")) ==
        "t.ply:13: vertex index 1.5 is out of range: valid are 0 .. 2");
  CHECK(error_of(triangle(face, "3 0 one 2\n")) == "t.ply:13: 'one' is not a number");
  CHECK(error_of(triangle(face, "3 0 1")) == "t.ply:13: the file is truncated");
  CHECK(error_of(triangle(face, "-1 0 1 2")) == "t.ply:13: -1 is not the length of a list");
  CHECK(error_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n") ==
        "t.ply:6: the element 'vertex' has no x, y and z");
  const std::string whole = square("binary_little_endian");
  CHECK(error_of(whole.substr(0, whole.size() - 1)) ==
        "t.ply: at byte " + std::to_string(whole.size() - 4) + ": the file is truncated");
  // A forged count is refused before memory is taken.
  CHECK(error_of("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float "
                 "x\nproperty float y\n"
                 "property float z\nend_header\n") ==
        "t.ply: the file is too short for its 4000000000 elements 'vertex'");
}
