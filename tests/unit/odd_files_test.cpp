#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "castray/image.h"
#include "castray/scene.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

using Files = std::map<std::string, std::string>;

/// Loads "o.obj" of a folder with these files; names in warnings are those of the files.
struct Loaded {
  explicit Loaded(const Files& files) {
    const TemporaryFolder folder;
    for (const auto& [name, content] : files) std::ofstream(folder / name, std::ios::binary) << content;
    Image image(1, 1);
    image.pixels = {{0.5f, 0.25f, 0.125f}};
    write_image(folder / "Wood Grain.pfm", image);
    std::filesystem::create_directory(folder / "textures");
    write_image(folder / "textures/oak.pfm", image);
    scene = load_scene(folder / "o.obj");
    const std::string prefix = (folder / "").string();
    for (const SceneWarning& warning : scene.warnings) {
      std::string text = warning.text();
      for (std::size_t at; (at = text.find(prefix)) != text.npos;) text.erase(at, prefix.size());
      (warning.harmless ? notes : warnings).push_back(text);
    }
  }
  Vec3d kd(std::uint32_t triangle = 0) const { return scene.material_of(triangle).kd; }

  Scene scene;
  std::vector<std::string> warnings, notes;
};

const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const Vec3d grey{0.5, 0.5, 0.5}, dark{0.2, 0.2, 0.2};
const std::string dark_mtl = "newmtl m\nKd .2 .2 .2\n";

struct Case {
  std::string what;
  Files files;
  Vec3d kd;
  std::vector<std::string> warnings, notes{};
};

std::string face(const std::string& before) { return before + three + "f 1 2 3\n"; }
std::string textured_face(const std::string& before) {
  return before + three + "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
}

const std::vector<Case> cases = {
    {"no library",
     {{"o.obj", face("mtllib lost.mtl\nusemtl m\n")}},
     grey,
     {"o.obj:1: mtllib: no such file: lost.mtl",
      "o.obj:2: usemtl of a material that is in no library that was found; the default, grey, is used"}},
    {"one of two libraries",
     {{"o.obj", face("mtllib lost.mtl m.mtl\nusemtl m\n")}, {"m.mtl", dark_mtl}},
     dark,
     {"o.obj:1: mtllib: no such file: lost.mtl"}},
    {"no mtllib",
     {{"o.obj", face("usemtl m\n") + "usemtl n\nf 1 2 3\n"}},
     grey,
     {"o.obj:1: usemtl, but no mtllib; the default, grey, is used (2 times)"}},
    {"mtllib behind usemtl",
     {{"o.obj", face("usemtl m\nmtllib m.mtl\n")}, {"m.mtl", dark_mtl}},
     dark,
     {},
     {"o.obj:1: usemtl in front of the mtllib that has the material"}},
    {"mtllib without a name",
     {{"o.obj", face("mtllib\n")}},
     grey,
     {},
     {"o.obj:1: mtllib without a file name"}},
    {"unknown name",
     {{"o.obj", face("mtllib m.mtl\nusemtl other\n")}, {"m.mtl", dark_mtl}},
     grey,
     {"o.obj:2: material 'other' not found; known: m; the default, grey, is used"}},
    {"usemtl without a name",
     {{"o.obj", face("mtllib m.mtl\nusemtl \n")}, {"m.mtl", dark_mtl}},
     grey,
     {"o.obj:2: usemtl without a name; the default, grey, is used"}},
    {"newmtl without a name",
     {{"o.obj", face("mtllib m.mtl\nusemtl\n")}, {"m.mtl", "newmtl \nKd .2 .2 .2\n"}},
     dark,
     {},
     {"m.mtl:1: newmtl without a name"}},
    {"newmtl twice of one name",
     {{"o.obj", face("mtllib m.mtl\nusemtl m\n")}, {"m.mtl", dark_mtl + "newmtl m\nKd 1 1 1\nnewmtl m\n"}},
     dark,
     {"m.mtl:3: newmtl of a name that is there already: the first material of it counts (2 times)"}},
    {"capitals beside what is meant",
     {{"o.obj", face("mtllib m.mtl\nusemtl m\nV 1 2 3\n") + "F 1 2 3\n"}, {"m.mtl", dark_mtl}},
     dark,
     {"o.obj:3: a statement in capitals means nothing; write v, vn, vt and f (2 times)"}},
    {"unused names matter to nobody",
     {{"o.obj", "mtllib m.mtl\nusemtl other\n" + face("usemtl m\n")}, {"m.mtl", dark_mtl}},
     dark,
     {}},
    {"indices 0",
     {{"o.obj", three + "vt 0 0\nvn 0 0 1\nf 1/0/0 2/0/0 3/0/0\n"}},
     grey,
     {"o.obj:6: texture coordinate index 0 is read as none (3 times)",
      "o.obj:6: normal index 0 is read as none (3 times)"}},
    {"indices of what the file has none of",
     {{"o.obj", three + "f 1/1/1 2/2/2 3/-1/-1\n"}},
     grey,
     {"o.obj:4: a face names texture coordinates, but there are none before it; it gets none (3 times)",
      "o.obj:4: a face names normals, but there are none before it; it gets none (3 times)"}},
    {"short faces",
     {{"o.obj", face("") + "f 1\nf 1 2\nf\n"}},
     grey,
     {"o.obj:5: a face of fewer than 3 corners is left out (3 times)"}},
    {"trailing comments",
     {{"o.obj", face("mtllib m.mtl # of all\nusemtl m\t# note\n")}, {"m.mtl", dark_mtl}},
     dark,
     {}},
    {"trailing comment of newmtl",
     {{"o.obj", face("mtllib m.mtl\nusemtl m\n")}, {"m.mtl", "newmtl m # note\nKd .2\n"}},
     dark,
     {}},
    {"names with '#'",
     {{"o.obj", face("mtllib #1 m.mtl\nusemtl m #2\n")},
      {"#1 m.mtl", "newmtl m #1\nKd 1\nnewmtl m #2\nKd .2\n"}},
     dark,
     {}},
    {"a name with another number",
     {{"o.obj", face("mtllib m.mtl\nusemtl m #3\n")}, {"m.mtl", "newmtl m #1\nnewmtl m #2\nKd .2\n"}},
     grey,
     {"o.obj:2: material 'm #3' not found; did you mean 'm #1'?; the default, grey, is used"}},
    {"quotes",
     {{"o.obj", face("mtllib \"my m.mtl\"\nusemtl \"my m\"\n")}, {"my m.mtl", "newmtl my m\nKd .2\n"}},
     dark,
     {}},
    {"quotes in the library only",
     {{"o.obj", face("mtllib 'my m.mtl' # one\nusemtl my m\n")}, {"my m.mtl", "newmtl \"my m\"\nKd .2\n"}},
     dark,
     {}},
    {"escapes",
     {{"o.obj", face("mtllib my\\ m.mtl\nusemtl my\\ m\n")}, {"my m.mtl", "newmtl my m\nKd .2\n"}},
     dark,
     {}},
    {"letters of other case",
     {{"o.obj", face("mtllib M.MTL\nusemtl m\n")}, {"m.mtl", "newmtl m\nkd .2\n"}},
     dark,
     {}},
    {"a library elsewhere",
     {{"o.obj", face("mtllib C:\\author\\m.mtl\nusemtl m\n")}, {"m.mtl", dark_mtl}},
     dark,
     {},
     {"o.obj:1: mtllib: C:\\author\\m.mtl is not there; m.mtl is read"}},
    {"Kd above 1",
     {{"o.obj", face("mtllib m.mtl\nusemtl m\n")}, {"m.mtl", "newmtl m\nKd 1.5 .25 -1\nKs 2 0 0\n"}},
     {1, 0.25, 0},
     {"m.mtl:2: Kd outside 0 .. 1: clamped (2 times)", "m.mtl:3: Ks outside 0 .. 1: clamped"}},
    {"a statement in front of newmtl",
     {{"o.obj", face("mtllib m.mtl\nusemtl m\n")}, {"m.mtl", "Kd 1 1 1\n" + dark_mtl}},
     dark,
     {"m.mtl:1: 'Kd' in front of the first newmtl is left out"}},
    {"no texture",
     {{"o.obj", face("mtllib m.mtl\nusemtl m\n")}, {"m.mtl", dark_mtl + "map_Kd lost.png\n"}},
     dark,
     {"m.mtl:3: map_Kd: no such file: lost.png"}},
    {"an unknown image format",
     {{"o.obj", face("mtllib m.mtl\nusemtl m\n")}, {"m.mtl", dark_mtl + "map_Kd t.dds\n"}, {"t.dds", ""}},
     dark,
     {"m.mtl:3: map_Kd: not an image format that is read: t.dds"}},
    {"a texture elsewhere",
     {{"o.obj", textured_face("mtllib m.mtl\nusemtl m\n")},
      {"m.mtl", "newmtl m\nmap_Kd -s 2 2 /home/author/tex/wood grain.pfm\n"}},
     {1, 1, 1},
     {},
     {"m.mtl:2: map_Kd: /home/author/tex/wood grain.pfm is not there; Wood Grain.pfm is used"}},
    {"a texture elsewhere, of Windows",
     {{"o.obj", textured_face("mtllib m.mtl\nusemtl m\n")},
      {"m.mtl", "newmtl m\nmap_Kd \"D:\\tex\\Wood Grain.pfm\" # one\n"}},
     {1, 1, 1},
     {},
     {"m.mtl:2: map_Kd: \"D:\\tex\\Wood Grain.pfm\" # one is not there; Wood Grain.pfm is used"}},
    {"a texture in a folder beside the file, elsewhere on the author's disk",
     {{"o.obj", textured_face("mtllib m.mtl\nusemtl m\n")},
      {"m.mtl", "newmtl m\nmap_Kd D:\\project\\textures\\oak.pfm\n"}},
     {1, 1, 1},
     {},
     {"m.mtl:2: map_Kd: D:\\project\\textures\\oak.pfm is not there; textures/oak.pfm is used"}},
    {"images without texture coordinates",
     {{"o.obj", face("mtllib m.mtl\nusemtl m\n") + "f 1 2 3\n"},
      {"m.mtl", dark_mtl + "map_Kd Wood Grain.pfm\n"}},
     dark,
     {"o.obj: material 'm' has images, but triangles without texture coordinates: they get the constants "
      "alone "
      "(2 times)"}},
    {"faces of old files",
     {{"o.obj", "mtllib m.mtl\nusemtl m\n" + three + "fo 1 2 3\n"}, {"m.mtl", dark_mtl}},
     dark,
     {}},
    {"a comment that ends in a backslash",
     {{"o.obj", face("# C:\\files\\\nmtllib m.mtl\nusemtl m\n")}, {"m.mtl", dark_mtl}},
     dark,
     {}},
};

}  // namespace

TEST_CASE("what is missing or odd in others' files is told once, with its place, and rendered") {
  for (const Case& odd : cases) {
    INFO(odd.what);
    const Loaded loaded(odd.files);
    CHECK(loaded.kd() == odd.kd);
    CHECK(loaded.warnings == odd.warnings);
    CHECK(loaded.notes == odd.notes);
  }
}

TEST_CASE("a library that is named often is read once, and only what is used counts") {
  std::string obj, mtl;
  for (int i = 0; i < 42; ++i) mtl += "newmtl m" + std::to_string(i) + "\nKd .5 .5 .5\nKd 2 0 0\n";
  for (int i = 0; i < 1561; ++i)
    obj += "mtllib m.mtl\n" + three + "usemtl m" + std::to_string(i % 40) + "\nf -3 -2 -1\n";
  const Loaded loaded(Files{{"o.obj", obj}, {"m.mtl", mtl}});
  CHECK(loaded.scene.materials.size() == 40);
  CHECK(loaded.scene.triangles.size() == 1561);
  CHECK(loaded.warnings == std::vector<std::string>{"m.mtl:3: Kd outside 0 .. 1: clamped (42 times)"});
}

TEST_CASE("a triangle whose vertex normals all oppose it is turned round") {
  const Loaded turned(
      Files{{"o.obj", three + "vn 0 0 -1\nvn 1 0 -1\nvn 1 0 1\nf 1//1 2//1 3//2\nf 1//1 2//1 3//3\n"}});
  const Scene& scene = turned.scene;
  const auto normal = [&](std::uint32_t t) {
    const Index3& c = scene.triangles[t];
    const Vec3f& a = scene.positions[c[0]];
    return cross(scene.positions[c[1]] - a, scene.positions[c[2]] - a).z;
  };
  CHECK(normal(0) < 0);
  CHECK(normal(1) > 0);                                      // one of its normals agrees
  CHECK(scene.normals[scene.triangle_normals[0][1]].x > 0);  // the third corner's, now the second
  CHECK(turned.warnings ==
        std::vector<std::string>{
            "o.obj:7: a triangle's three normals oppose the order of its corners, which is turned round"});
}

TEST_CASE("vertex colours stand for a Kd that is not given") {
  const std::string colored = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 0.5\n";
  const Loaded loaded(
      Files{{"o.obj", "mtllib m.mtl\n" + colored + "f 1 2 3\nusemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\n"},
            {"m.mtl", dark_mtl + "newmtl n\nNs 1\n"}});
  const Scene& scene = loaded.scene;
  CHECK(loaded.warnings.empty());
  REQUIRE(scene.triangle_colors.size() == 3);
  const auto color = [&](std::size_t corner) { return scene.colors[scene.triangle_colors[0][corner]]; };
  CHECK(color(0) == Vec3f{1, 0, 0});
  CHECK(color(1) == Vec3f{0, 1, 0});
  CHECK(color(2).z == Approx(0.21404114));  // sRGB's 0.5
  CHECK(scene.material_of(0).vertex_colors);
  CHECK(loaded.kd(0) == Vec3d{1, 1, 1});
  CHECK(!scene.material_of(1).vertex_colors);
  CHECK(loaded.kd(1) == dark);
  CHECK(scene.material_of(2).vertex_colors);
  const Loaded bytes(Files{{"o.obj", "v 0 0 0 255 0 0\nv 1 0 0 255 255 255\nv 0 1 0\nf 1 2 3\n"}});
  REQUIRE(bytes.scene.colors.size() == 3);
  CHECK(bytes.scene.colors[0].x == Approx(1));
  CHECK(bytes.scene.colors[0].y == 0);
  CHECK(bytes.scene.colors[1].z == Approx(1));
  CHECK(bytes.scene.colors[2].y == Approx(1));
  CHECK(Loaded(Files{{"o.obj", "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n"}}).scene.colors.empty());
}

TEST_CASE("smoothing groups and smooth normals are means of the faces around a vertex, by their angles") {
  // A roof: two squares that meet at (0,1,z) by a right angle; each vertex of the ridge has a corner of 90
  // degrees of one face and two of 45 of the other, whatever the cut.
  const std::string roof = "v -1 0 -1\nv 0 1 -1\nv 1 0 -1\nv -1 0 1\nv 0 1 1\nv 1 0 1\n";
  const auto ridge = [](const Scene& scene, std::uint32_t t, std::size_t i) {
    const std::uint32_t n = scene.triangle_normals.empty() ? Scene::no_index : scene.triangle_normals[t][i];
    return n == Scene::no_index ? Vec3f{} : scene.normals[n];
  };
  const Loaded grouped(Files{{"o.obj", roof + "s 1\nf 1 4 5 2\nf 2 5 6 3\n"}});
  CHECK(ridge(grouped.scene, 0, 2).x == Approx(0).margin(1e-6));
  CHECK(ridge(grouped.scene, 0, 2).y == Approx(1));
  CHECK(ridge(grouped.scene, 0, 0).x == Approx(-std::sqrt(0.5)));
  const Loaded apart(Files{{"o.obj", roof + "s 1\nf 1 4 5 2\ns 2\nf 2 5 6 3\n"}});
  CHECK(ridge(apart.scene, 0, 2).x == Approx(-std::sqrt(0.5)));
  CHECK(ridge(apart.scene, 2, 0).x == Approx(std::sqrt(0.5)));
  const Loaded half(Files{{"o.obj", roof + "s 1\nf 1 4 5 2\ns off\nf 2 5 6 3\n"}});
  CHECK(ridge(half.scene, 0, 2).x == Approx(-std::sqrt(0.5)));
  CHECK(half.scene.triangle_normals[2][0] == Scene::no_index);
  CHECK(Loaded(Files{{"o.obj", roof + "s 0\nf 1 4 5 2\n"}}).scene.triangle_normals.empty());

  const auto in_scene = [&](const std::string& normals) {
    const TemporaryFolder folder;
    // The second square has corners of its own at the ridge.
    std::ofstream(folder / "o.obj") << roof << "v 0 1 -1\nv 0 1 1\nf 1 4 5 2\nf 7 8 6 3\n";
    std::ofstream(folder / "s.json") << R"({ "meshes": [ { "obj": "o.obj", )" << normals << " } ] }";
    return load_scene(folder / "s.json");
  };
  CHECK(ridge(in_scene(R"("normals": "smooth")"), 0, 2).y == Approx(1));
  CHECK(ridge(in_scene(R"("normals": "smooth", "crease_angle": 91)"), 2, 0).y == Approx(1));
  CHECK(ridge(in_scene(R"("normals": "smooth", "crease_angle": 89)"), 2, 0).x == Approx(std::sqrt(0.5)));
  CHECK(in_scene(R"("normals": "file")").triangle_normals.empty());
}

TEST_CASE("meshes of one file share it and its materials") {
  const TemporaryFolder folder;
  std::ofstream(folder / "o.obj") << "mtllib lost.mtl\nusemtl m\n" + face("") + "f 1 2\n";
  std::ofstream(folder / "none.obj") << three;
  std::string meshes;
  for (int i = 0; i < 50; ++i)
    meshes += R"({ "obj": "o.obj", "transform": [ { "translate": [)" + std::to_string(i) + ", 0, 0] } ] },";
  std::ofstream(folder / "s.json") << R"({ "meshes": [ )" + meshes + R"({ "obj": "none.obj" } ] })";
  const Scene scene = load_scene(folder / "s.json");
  CHECK(scene.triangles.size() == 50);
  CHECK(scene.materials.size() == 1);
  std::vector<std::string> told;
  for (const SceneWarning& warning : scene.warnings) told.push_back(warning.message);
  CHECK(told == std::vector<std::string>{
                    "a face of fewer than 3 corners is left out", "mtllib: no such file: lost.mtl",
                    "usemtl of a material that is in no library that was found; the default, grey, is used",
                    "has no faces"});
  CHECK(scene.to_world(Vec3d(scene.positions[scene.triangles[49][0]])).x == Approx(49));
}

TEST_CASE("replaced materials that a mesh does not have are told, with what it has") {
  const TemporaryFolder folder;
  std::ofstream(folder / "o.obj") << "mtllib m.mtl\nusemtl wood\n" + face("");
  std::ofstream(folder / "m.mtl") << "newmtl wood\n";
  std::ofstream(folder / "t.ply")
      << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
         "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  std::ofstream(folder / "s.json") << R"({ "materials": { "a": { "type": "diffuse" } }, "meshes": [
    { "obj": "o.obj", "materials": { "wod": "a" } },
    { "obj": "o.obj", "materials": { "wood": "a" } },
    { "ply": "t.ply", "materials": { "wood": "a" } } ] })";
  std::vector<std::string> told;
  for (const SceneWarning& warning : load_scene(folder / "s.json").warnings)
    told.push_back(std::to_string(warning.place.line) + ": " + warning.message);
  CHECK(told == std::vector<std::string>{
                    "2: \"materials\": no triangle of the mesh has a material 'wod'; did you mean 'wood'?",
                    "4: \"materials\": no triangle of the mesh has a material 'wood'; its file names none"});
}
