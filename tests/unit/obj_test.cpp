#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <string>

#include "castray/image.h"
#include "castray/scene.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// A folder with an OBJ file in it, and what else a test puts there.
struct Input {
  TemporaryFolder folder;

  explicit Input(const std::string& obj) { write("o.obj", obj); }
  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << content;
  }
  Scene load() const { return load_scene(folder / "o.obj"); }
};

Scene load_text(const std::string& obj) { return Input(obj).load(); }

Vec3d corner(const Scene& scene, std::uint32_t triangle, std::size_t i) {
  return scene.to_world(Vec3d(scene.positions[scene.triangles[triangle][i]]));
}

/// Sum of the triangles' area vectors, and of their lengths: equal in size for a flat polygon cut without
/// overlap.
struct Areas {
  Vec3d vector;
  double sum = 0;
};
Areas areas(const Scene& scene) {
  Areas result;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const Vec3d a = corner(scene, t, 0);
    const Vec3d area = cross(corner(scene, t, 1) - a, corner(scene, t, 2) - a) * 0.5;
    result.vector += area;
    result.sum += length(area);
  }
  return result;
}

const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("OBJ files come as they are written") {
  for (const std::string& text :
       {three + "f 1 2 3", "\xef\xbb\xbf" + three + "f 1 2 3\n", three + "f -3 -2 -1\n",
        three + "f 1 2 \\\n3\n", three + "f 1 \\ \n2 \\\t\n 3\n",
        three + "v 1.#IND -1.#QNAN0 1.#INF00\nf 1 2 3\n", "  " + three + "\tf  1\t2 3 # a face\n",
        three + "vx what\nf 1// 2 3/\n"}) {
    INFO(text);
    const Scene scene = load_text(text);
    REQUIRE(scene.triangles.size() == 1);
    CHECK(corner(scene, 0, 0) == Vec3d{0, 0, 0});
    CHECK(corner(scene, 0, 1) == Vec3d{1, 0, 0});
    CHECK(corner(scene, 0, 2) == Vec3d{0, 1, 0});
  }
  std::string windows = three + "f 1 2 3\n";
  for (std::size_t i = 0; (i = windows.find('\n', i)) != std::string::npos; i += 2)
    windows.replace(i, 1, "\r\n");
  CHECK(load_text(windows).triangles.size() == 1);
  std::string old_mac = three + "f 1 2 3\n";
  for (char& c : old_mac)
    if (c == '\n') c = '\r';
  CHECK(load_text(old_mac).triangles.size() == 1);
}

TEST_CASE("faces may come before their vertices") {
  const std::string corners = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\n",
                    uvs = "vt 0 0\nvt 1 0\nvt 0 1\n", normal = "vn 0 0 1\n", face = "f 1/1/1 2/2/1 3/3/1\n";
  const Scene usual = load_text(corners + uvs + normal + face);
  for (const std::string& text : {face + corners + uvs + normal, corners + face + uvs + normal,
                                  corners + "f -3/1/1 -2/2/1 -1/3/1\nv 1 1 0\n" + uvs + normal}) {
    CAPTURE(text);
    const Scene scene = load_text(text);
    CHECK(scene.warnings.size() == usual.warnings.size());
    REQUIRE(scene.triangles.size() == 1);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(corner(scene, 0, i) == corner(usual, 0, i));
      CHECK(scene.uvs[scene.triangle_uvs[0][i]] == usual.uvs[usual.triangle_uvs[0][i]]);
    }
  }
}

TEST_CASE("coordinates are read in double and re-centred before they are rounded") {
  const Scene scene = load_text("v 1e7 0 0\nv 10000000.25 0 0\nv 1e7 0.125 0\nf 1 2 3\n");
  CHECK(corner(scene, 0, 1).x - corner(scene, 0, 0).x == 0.25);
  CHECK(corner(scene, 0, 2).y - corner(scene, 0, 0).y == 0.125);
}

TEST_CASE("polygons are cut without overlap, concave ones too") {
  struct Polygon {
    const char* name;
    std::string text;
    double area;
    std::size_t triangles;
  };
  std::string star, circle, comb = "v 0 -1 0\n";
  std::string star_face = "f", circle_face = "f", comb_face = "f 1";
  for (int i = 0; i < 20; ++i) {
    const double r = i % 2 ? 0.3 : 1, angle = i * M_PI / 10;
    star += "v 0 " + std::to_string(r * std::cos(angle)) + " " + std::to_string(r * std::sin(angle)) + "\n";
    star_face += " " + std::to_string(i + 1);
  }
  for (int i = 0; i < 1000; ++i) {
    const double angle = i * M_PI / 500;
    circle += "v " + std::to_string(std::cos(angle)) + " 0 " + std::to_string(-std::sin(angle)) + "\n";
    circle_face += " " + std::to_string(i + 1);
  }
  comb = "v 0 -1 0\nv 100 -1 0\n";
  comb_face = "f 1 2";
  for (int i = 100; i >= 0; --i) {
    comb += "v " + std::to_string(i) + (i % 2 ? " 0 0\n" : " 1 0\n");
    comb_face += " " + std::to_string(103 - i);
  }
  const Polygon polygons[] = {
      {"square", square + "f 1 2 3 4\n", 1, 2},
      {"arrow: a concave quad", "v 0 0 0\nv 2 2 0\nv 0 1 0\nv -2 2 0\nf 1 2 3 4\n", 2, 2},
      {"arrow, from another corner", "v 0 0 0\nv 2 2 0\nv 0 1 0\nv -2 2 0\nf 2 3 4 1\n", 2, 2},
      {"a corner on an edge", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n", 4, 3},
      {"star", star + star_face + "\n", 10 * 0.3 * std::sin(M_PI / 10), 18},
      {"circle", circle + circle_face + "\n", 500 * std::sin(M_PI / 500), 998},
      {"comb", comb + comb_face + "\n", 150, 101},
  };
  for (const Polygon& polygon : polygons) {
    INFO(polygon.name);
    const Scene scene = load_text(polygon.text);
    CHECK(scene.triangles.size() == polygon.triangles);
    const Areas found = areas(scene);
    CHECK(found.sum == Approx(polygon.area).epsilon(1e-4));
    CHECK(length(found.vector) == Approx(found.sum).epsilon(1e-6));
  }
}

TEST_CASE("a polygon with a great many corners in a line is cut without overlap") {
  // Upright, slanted (where rounding bends the line), and with a reflex corner above the line.
  for (const double slope : {0.0, 0.3})
    for (const bool notch : {false, true}) {
      constexpr int count = 20000;
      std::string text, corners = "f";
      for (int i = 0; i < count; ++i) {
        const double x = static_cast<double>(i) / (count - 1);
        text += "v " + std::to_string(x) + " " + std::to_string(slope * x) + " 0\n";
      }
      text += "v 1 2 0\n" + std::string(notch ? "v 0.5 1.5 0\n" : "") + "v 0 2 0\n";
      for (int i = 1; i <= count + (notch ? 3 : 2); ++i) corners += " " + std::to_string(i);
      const Areas found = areas(load_text(text + corners + "\n"));
      const double area = 2 - slope / 2 - (notch ? 0.25 : 0);
      CHECK(found.sum == Approx(area).epsilon(1e-4));
      CHECK(length(found.vector) == Approx(area).epsilon(1e-4));
    }
}

TEST_CASE("a convex quad is cut from its first corner") {
  const Scene scene = load_text(square + "f 1 2 3 4\n");
  CHECK(scene.triangles == std::vector<Index3>{{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE("degenerate triangles are dropped and counted") {
  const Scene scene =
      load_text(three + "v nan 0 0\nv inf 0 0\nv 0.5 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 2\nf 1 6 2\n");
  CHECK(scene.triangles.size() == 1);
  CHECK(scene.dropped_triangles == 4);
  CHECK(scene.positions.size() == 3);
  CHECK(corner(scene, 0, 1) == Vec3d{1, 0, 0});
}

TEST_CASE("a degenerate triangle far away does not spoil the precision of the others") {
  const Scene scene = load_text(three + "v 1e30 0 0\nf 1 2 3\nf 1 4 4\n");
  CHECK(scene.unit == 0.5);
}

TEST_CASE("materials follow the MTL mapping") {
  const Input input(
      "mtllib o.mtl\n" + three +
      "usemtl plain\nf 1 2 3\nusemtl lamp\nf 1 2 3\nusemtl phong\nf 1 2 3\nusemtl mirror\nf 1 2 3\n"
      "usemtl metal\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl air\nf 1 2 3\nusemtl rough\nf 1 2 3\n");
  input.write("o.mtl",
              "newmtl plain\nKd 0.1 0.2 0.3\nKa 1 1 1\nd 1\n"
              "newmtl lamp\nKd 0 0 0\nKe 3\n"
              "newmtl phong\nKd 0.5 0.5 0.5\nKs 0.4 0.4 0.4\nNs 48\nillum 2\n"
              "newmtl mirror\nKs 0.9 0.9 0.9\nillum 3\n"
              "newmtl metal\nKd 1 0.8 0.2\nPm 1\nPr 0.5\n"
              "newmtl glass\nNi 1.4\nillum 7\nNs 200\n"
              "newmtl air\nKd 0.2 0.2 0.2\nNi 1\nillum 4\n"
              "newmtl rough\nKs 0.1 0.1 0.1\nPr 0.3\nNs 3\n");
  const Scene scene = input.load();
  REQUIRE(scene.materials.size() == 8);
  const auto material = [&](std::uint32_t t) { return scene.material_of(t); };
  CHECK(material(0).type == MaterialType::diffuse);
  CHECK(material(0).kd == Vec3d{0.1, 0.2, 0.3});
  CHECK(material(1).ke == Vec3d{3, 3, 3});
  CHECK(scene.lights == std::vector<std::uint32_t>{1});
  CHECK(material(2).type == MaterialType::microfacet);
  CHECK(material(2).ks == Vec3d{0.4, 0.4, 0.4});
  CHECK(material(2).alpha == Approx(0.2));
  CHECK(material(3).type == MaterialType::conductor);
  CHECK(material(3).reflectance == Vec3d{0.9, 0.9, 0.9});
  CHECK(material(3).alpha == 0);
  CHECK(material(4).type == MaterialType::conductor);
  CHECK(material(4).reflectance == Vec3d{1, 0.8, 0.2});
  CHECK(material(4).alpha == 0.25);
  CHECK(material(5).type == MaterialType::dielectric);
  CHECK(material(5).ior == 1.4);
  CHECK(material(5).alpha == 0);
  CHECK(material(6).type == MaterialType::diffuse);
  CHECK(material(7).type == MaterialType::microfacet);
  CHECK(material(7).alpha == 0.09);
  const std::string mtl = (input.folder / "o.mtl").string();
  CHECK(scene.ignored_keys == std::vector<std::string>{mtl + ": Ka"});
}

TEST_CASE("material files are found whatever their names") {
  const std::string mtl = "newmtl a b\nKd 0.25 0.25 0.25\n";
  struct Naming {
    std::string written, file;
  };
  for (const auto& [written, file] :
       {Naming{"my scene.mtl", "my scene.mtl"}, Naming{"other.mtl  my scene.mtl ", "my scene.mtl"},
        Naming{"sub\\x.mtl", "sub/x.mtl"}, Naming{"sub dir\\my x.mtl\r", "sub dir/my x.mtl"}}) {
    INFO(written);
    const Input input("mtllib " + written + "\nusemtl a b \n" + three + "f 1 2 3\n");
    input.write("other.mtl", "newmtl c\n");
    input.write(file, mtl);
    CHECK(input.load().material_of(0).kd == Vec3d{0.25, 0.25, 0.25});
  }
}

TEST_CASE("map_Kd is read, with options and spaces in its name") {
  const Input input("mtllib o.mtl\nvt 0 0\nvt 1 0\nvt 0 1\n" + three +
                    "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 2/2 3/3\n");
  input.write("o.mtl",
              "newmtl a\nmap_Kd -s 2 -o 0.5 0.25 -mm 0 1 -blendu on sub\\my tile.pfm\n"
              "newmtl b\nKd 0.5 0.5 0.5\nmap_Kd sub/my tile.pfm\n");
  std::filesystem::create_directories(input.folder / "sub");
  Image image(2, 1);
  image.pixels = {{1, 0.5f, 0}, {0, 0, 1}};
  write_image(input.folder / "sub/my tile.pfm", image);
  const Scene scene = input.load();
  REQUIRE(scene.textures.size() == 1);
  CHECK(scene.textures[0].width == 2);
  CHECK(scene.textures[0].floats == std::vector<float>{1, 0.5f, 0, 0, 0, 1});
  CHECK(scene.material_of(0).kd == Vec3d{1, 1, 1});
  CHECK(scene.material_of(1).kd == Vec3d{0.5, 0.5, 0.5});
  REQUIRE(scene.triangle_uvs.size() == 2);
  const auto uv = [&](std::size_t t, std::size_t i) { return scene.uvs[scene.triangle_uvs[t][i]]; };
  CHECK(uv(0, 1) == std::array<float, 2>{1, 0});
  const TextureMap& map = scene.material_of(0).map(SurfaceParameter::kd);
  CHECK(map.scale == std::array<float, 2>{2, 1});
  CHECK(map.offset == std::array<float, 2>{0.5f, 0.25f});
}

TEST_CASE("options of a texture may stand in any order, in front of the name or behind it") {
  const auto map_of = [](const std::string& statement, const std::string& file) {
    const Input input("mtllib o.mtl\nvt 0 0\n" + three + "usemtl a\nf 1/1 2/1 3/1\n");
    input.write("o.mtl", "newmtl a\n" + statement + "\n");
    write_image(input.folder / file, Image(1, 1));
    const Scene scene = input.load();
    CHECK(scene.warnings.empty());
    return scene.material_of(0).map(SurfaceParameter::kd);
  };
  for (const std::string options : {"-s 2 3 1 -clamp on -o .5", "-o .5 -clamp on -cc off -s 2 3"})
    for (const std::string& statement : {"map_Kd " + options + " a b.pfm", "map_Kd a b.pfm " + options}) {
      INFO(statement);
      const TextureMap map = map_of(statement, "a b.pfm");
      CHECK(map.scale == std::array<float, 2>{2, 3});
      CHECK(map.offset == std::array<float, 2>{0.5f, 0});
      CHECK(map.clamp);
    }
  CHECK(map_of("map_Kd wood -s fine.pfm", "wood -s fine.pfm").used());
}

TEST_CASE("normals and texture coordinates stay with their triangles") {
  const Scene scene = load_text(three +
                                "v 0 0 1\nv 0 0 2\nvn 0 0 2\nvn 0 0 0\nvt 0.5 0.75\n"
                                "f 1 2 2\nf 1 2 3\nf 1//1 2//1 3//1\nf 1/1 2/1 3/1\nf 1//2 2//2 3//2\n");
  REQUIRE(scene.triangles.size() == 4);
  REQUIRE(scene.triangle_normals.size() == 4);
  REQUIRE(scene.triangle_uvs.size() == 4);
  CHECK(scene.triangle_normals[0][0] == Scene::no_index);
  CHECK(scene.normals[scene.triangle_normals[1][0]] == Vec3f{0, 0, 1});
  CHECK(scene.triangle_uvs[1][0] == Scene::no_index);
  CHECK(scene.uvs[scene.triangle_uvs[2][0]] == std::array<float, 2>{0.5f, 0.75f});
  CHECK(scene.triangle_normals[3][0] == Scene::no_index);
}

TEST_CASE("an OBJ file is seen whole by its automatic view") {
  const Scene scene = load_text("v 10 20 30\nv 14 20 30\nv 10 22 31\nf 1 2 3\n");
  for (const Vec3f& p : scene.positions) {
    const Vec3d seen = Vec3d(p) - scene.camera.position;
    const double depth = dot(seen, scene.camera.forward);
    CHECK(depth > 0);
    CHECK(std::abs(dot(seen, scene.camera.right)) < depth * scene.camera.tan_half_fov);
    CHECK(std::abs(dot(seen, scene.camera.up)) < depth * scene.camera.tan_half_fov);
  }
}
