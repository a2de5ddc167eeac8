// What a person sees who renders a mesh of another program without more ado.
#include <catch2/catch.hpp>

#include <fstream>
#include <iterator>
#include <sstream>

#include "castray/image.h"
#include "castray/scene.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;

namespace {

const std::string square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";

/// A floor and a lamp above it whose corners run counter-clockwise seen from above; `lamp` are its corners.
std::string lamp_room(const std::string& lamp) {
  return "mtllib m.mtl\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -.5 1.5 -.5\nv .5 1.5 -.5\nv .5 1.5 .5\nv "
         "-.5 1.5 .5\n"
         "vn 0 -1 0\nusemtl floor\nf 4 3 2 1\nusemtl lamp\nf " +
         lamp + "\n";
}
const std::string lamp_materials = "newmtl floor\nKd .8 .8 .8\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n";

/// A folder with o.obj and m.mtl, in which castray renders.
struct Mesh {
  TemporaryFolder folder;

  explicit Mesh(const std::string& obj, const std::string& mtl = "") {
    std::ofstream(folder / "o.obj") << obj;
    std::ofstream(folder / "m.mtl") << mtl;
  }
  RunResult render(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"render", "o.obj",        "--size",    "32x32", "--spp",
                                       "16",     "--integrator", "reference", "-o",    "o.pfm"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_castray(arguments, folder.path());
  }
  Image image() const { return read_image(folder / "o.pfm").image; }
  Vec3f middle() const { return image().pixels[16 * 32 + 16]; }
};

/// What follows `key` on its line of `castray info`.
std::string told(const std::string& info, const std::string& key) {
  const std::size_t at = info.find(key), begin = at + key.size();
  return at == info.npos ? "" : info.substr(begin, info.find('\n', begin) - begin);
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

float brightest(const Image& image) {
  float most = 0;
  for (const Vec3f& pixel : image.pixels) most = std::max(most, max_component(pixel));
  return most;
}

}  // namespace

TEST_CASE("a mesh without lights is lit by a white sky, or by the environment of the flag") {
  const Mesh mesh(square + "f 1 2 3 4\n");
  const RunResult outcome = mesh.render({});
  CHECK_THAT(outcome.err, Contains("nothing in o.obj emits light, so a white sky does"));
  CHECK(mesh.middle().x == Approx(0.5).epsilon(0.01));
  CHECK(mesh.image().pixels[0] == Vec3f{1, 1, 1});
  mesh.render({"--environment", "1,0.5,0"});
  CHECK(mesh.middle().x == Approx(0.5).epsilon(0.01));
  CHECK(mesh.middle().y == Approx(0.25).epsilon(0.01));
  CHECK(mesh.middle().z == 0);
  const RunResult dark = mesh.render({"--environment", "off"});
  CHECK_THAT(dark.err, Contains("nothing in the scene emits light: the image will be black"));
  CHECK(brightest(mesh.image()) == 0);
}

TEST_CASE("the environment of the flag may be an image, as in a scene file") {
  const Mesh mesh(square + "f 1 2 3 4\n");
  Image sky(4, 2);
  for (std::size_t i = 0; i < 8; ++i) sky.pixels[i] = Vec3f(0.5f * static_cast<float>(i));
  write_image(mesh.folder / "sky.exr", sky);
  std::ofstream(mesh.folder / "sky.json")
      << R"({ "meshes": [ { "obj": "o.obj" } ], "environment": { "image": "sky.exr" } })";
  const auto picture = [&](std::vector<std::string> scene) {
    scene.insert(scene.begin(), "render");
    for (const char* word : {"-q", "--size", "8x8", "--spp", "2", "-o", "o.pfm"}) scene.push_back(word);
    CHECK(run_castray(scene, mesh.folder.path()).err == "");
    return read_file(mesh.folder / "o.pfm");
  };
  const std::string by_flag = picture({"o.obj", "--environment", "sky.exr"});
  CHECK(brightest(mesh.image()) > 1);
  CHECK(by_flag == picture({"sky.json"}));
}

TEST_CASE("a mesh whose screen glows no brighter than white is lit by the sky, one with a lamp is not") {
  const std::string screen = "mtllib m.mtl\nusemtl wall\n" + square + "f 1 2 3\nusemtl screen\nf 1 3 4\n";
  const std::string wall = "newmtl wall\nKd .5 .5 .5\nnewmtl screen\nKd 0 0 0\n";
  const Mesh dial(screen, wall + "Ke 0.2 1 0.2\n");
  const RunResult outcome = dial.render({"--look-from", "1,0,3"});
  CHECK_THAT(outcome.err, Contains("nothing in o.obj emits more than white, so a white sky does"));
  CHECK(dial.middle().x == Approx(0.5).epsilon(0.01));
  CHECK(brightest(dial.image()) == 1);
  CHECK_THAT(
      run_castray({"info", "o.obj"}, dial.folder.path()).out,
      Contains("lights     1 triangles: screen; environment (1, 1, 1), as nothing in the scene emits more"));
  CHECK_FALSE(load_scene(Mesh(screen, wall + "Ke 0.2 1.1 0.2\n").folder / "o.obj").default_environment);
  std::ofstream(dial.folder / "s.json") << R"({ "meshes": [ { "obj": "o.obj" } ] })";
  CHECK_FALSE(load_scene(dial.folder / "s.json").default_environment);
}

TEST_CASE("info tells what of which image each parameter reads, and how") {
  const Mesh mesh("mtllib m.mtl\nusemtl a\n" + square + "vt 0 0\nf 1/1 2/1 3/1\n",
                  "newmtl a\nKd .9 .8 .7\nmap_Kd -s 2 3 -o .5 0 -clamp on g.ppm\nPr .5\n"
                  "map_Pr -mm .1 .5 -imfchan g g.ppm\nKs .2 .2 .2\nbump -bm .25 g.ppm\nd .5\n");
  std::ofstream(mesh.folder / "g.ppm") << "P3 1 1 255 128 128 128\n";
  const std::string info = run_castray({"info", "o.obj"}, mesh.folder.path()).out;
  CHECK(told(info, "  a: ") ==
        "microfacet, kd (0.9, 0.8, 0.7) times g.ppm (1 x 1, uv times (2, 3), uv plus (0.5, 0), clamped), ks "
        "(0.2, 0.2, 0.2), roughness 0.5 times g.ppm (1 x 1, green, as 0.1 + 0.5 texel), coverage 0.5, "
        "bump_map g.ppm (1 x 1, gain 0.25)");
}

TEST_CASE("a room without its front is looked into, from wherever the front was") {
  // Walls of a cube face inwards; the one that is left out is open.
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
  const std::pair<std::string, Vec3d> walls[] = {{"f 1 2 3 4\n", {0, 0, -1}},
                                                 {"f 8 7 6 5\n", {0, 0, 1}},
                                                 {"f 5 1 4 8\n", {-1, 0, 0}},
                                                 {"f 2 6 7 3\n", {1, 0, 0}},
                                                 {"f 4 3 7 8\n", {0, 1, 0}}};
  for (const auto& [open, towards_viewer] : walls) {
    std::string room = corners + "f 1 5 6 2\n";
    for (const auto& wall : walls)
      if (wall.first != open) room += wall.first;
    const TemporaryFolder folder;
    std::ofstream(folder / "o.obj") << room;
    const Scene scene = load_scene(folder / "o.obj");
    CHECK(dot(scene.camera.forward, -towards_viewer) > 0.99);
  }
}

TEST_CASE("a plant in a pot is not looked at from below, where all that is seen is outward") {
  std::string plant =  // a slab
      "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 .1 -1\nv 1 .1 -1\nv 1 .1 1\nv -1 .1 1\n"
      "f 1 2 3 4\nf 8 7 6 5\n";
  for (int leaf = 0; leaf < 12; ++leaf) {  // upright squares; every other one shows its inward side
    const double x = leaf % 4 * 0.5 - 0.9, z = leaf / 4 * 0.5 - 0.5;
    for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {0.4, 0.0}, {0.4, 0.6}, {0.0, 0.6}})
      plant += "v " + std::to_string(x + dx) + " " + std::to_string(0.5 + dy) + " " +
               std::to_string(z + dx / 3) + "\n";
    plant += leaf % 2 ? "f -1 -2 -3 -4\n" : "f -4 -3 -2 -1\n";
  }
  const TemporaryFolder folder;
  std::ofstream(folder / "o.obj") << plant;
  CHECK(dot(load_scene(folder / "o.obj").camera.forward, normalize(Vec3d{-0.5, -0.4, -1})) > 0.999);
}

TEST_CASE("the view that info prints, as flags or as JSON, is the automatic one") {
  // Far from the origin, as maps are.
  const Mesh mesh(
      "v 500123.25 120.5 5412345.75\nv 500128.81 120.5 5412351.342\nv 500123.25 125.988 5412345.75\nf 1 2 "
      "3\nf 3 2 1\n");
  REQUIRE(mesh.render({}).exit_code == 0);
  const Image automatic = mesh.image();
  const std::string info = run_castray({"info", "o.obj"}, mesh.folder.path()).out;
  CHECK(told(info, "bounds     ") == "(500123.25, 120.5, 5412345.75) .. (500128.81, 125.988, 5412351.342)");
  const auto same = [&](const Image& image) {
    double difference = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      difference += std::abs(double(image.pixels[i].x - automatic.pixels[i].x));
    return difference < 0.01 * double(image.pixels.size());
  };
  REQUIRE(mesh.render(words(told(info, "view       "))).exit_code == 0);
  CHECK(same(mesh.image()));
  std::ofstream(mesh.folder / "s.json")
      << "{ " << told(info, "--fov 40\n           ") << R"(, "meshes": [ { "obj": "o.obj" } ] })";
  REQUIRE(run_castray({"render", "s.json", "--size", "32x32", "--spp", "16", "--integrator", "reference",
                       "-o", "o.pfm"},
                      mesh.folder.path())
              .exit_code == 0);
  CHECK(same(mesh.image()));
}

TEST_CASE("a black image comes with its reason") {
  const std::vector<std::string> view{"--look-from", "0,1,6", "--look-at", "0,0.6,0"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), view.begin(), view.end());
    return more;
  };
  const Mesh away(lamp_room("8 7 6 5"), lamp_materials);
  const RunResult outcome = away.render(view);
  CHECK(outcome.exit_code == 0);
  CHECK(brightest(away.image()) == 0);
  CHECK_THAT(outcome.err, Contains("the image is black: its lights face away from all that is seen"));
  CHECK(away.render(with({"--two-sided-lights"})).err.find("black") == std::string::npos);
  CHECK(brightest(away.image()) > 0.1f);
  // Their vertex normals say where lamps shine.
  const Mesh turned(lamp_room("8//1 7//1 6//1 5//1"), lamp_materials);
  CHECK(turned.render(view).err.find("black") == std::string::npos);
  CHECK(brightest(turned.image()) > 0.1f);
  const Mesh lamp_alone("mtllib m.mtl\nusemtl lamp\n" + square + "f 4 3 2 1\n", lamp_materials);
  CHECK_THAT(lamp_alone.render({"--look-from", "0,0,3", "--look-at", "0,0,0"}).err,
             Contains("the image is black: its lights face away"));
  CHECK_THAT(turned.render({"--look-from", "0,1,6", "--look-at", "0,1,9"}).err,
             Contains("the image is black: the camera sees nothing of the scene"));
  CHECK_THAT(turned.render(with({"--max-depth", "1", "--crop", "0,31,32,32"})).err,
             Contains("--max-depth 1"));
}

TEST_CASE(
    "strict reading makes the first warning the error, without it render tells what changes the picture") {
  const Mesh mesh("mtllib lost.mtl\nusemtl m\n" + square + "f 1 2\nf 1 2 3 4\n");
  const RunResult strict = mesh.render({"--strict"});
  CHECK(strict.exit_code == 2);
  CHECK(strict.but_for_reading() == "castray: error: o.obj:7: a face of fewer than 3 corners is left out\n");
  const RunResult lenient = mesh.render({});
  CHECK(lenient.exit_code == 0);
  CHECK_THAT(lenient.err,
             Contains("castray: warning: o.obj:1: mtllib: no such file: lost.mtl\n") &&
                 Contains("castray: warning: o.obj:7: a face of fewer than 3 corners is left out\n"));
  CHECK(mesh.render({"-q"}).err.empty());
  CHECK(Mesh(square + "f 1 2 3 4\n").render({"--strict"}).exit_code == 0);
}

TEST_CASE("triangles with corners that are not finite are told once by render, and are errors when strict") {
  const std::string lost =
      "o.obj:6:7: a triangle is left out: a corner is nan, infinite or farther than 1e+100 from the origin";
  const Mesh mesh(square + "v nan 0 0\nf 1 2 5\nf 1 3 5\nf 1 2 2\nf 1 2 3 4\n");
  const RunResult lenient = mesh.render({});
  CHECK(lenient.exit_code == 0);
  CHECK_THAT(lenient.err,
             Contains("castray: warning: " + lost + " (2 times)\n") && !Contains("without area"));
  CHECK_THAT(mesh.render({"-v"}).err, Contains("o.obj:8: a triangle without area is left out\n"));
  const RunResult strict = mesh.render({"--strict"});
  CHECK(strict.exit_code == 2);
  CHECK(strict.but_for_reading() == "castray: error: " + lost + "\n");
}
