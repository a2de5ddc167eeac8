// What exporters' materials look like: a square seen straight on under a white sky.
#include <catch2/catch.hpp>

#include <fstream>

#include "castray/image.h"
#include "render_blocks.h"
#include "temporary_folder.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

constexpr int side = 32;

/// The square from (-1,-1) to (1,1), all of the image, with the material that `mtl` says; `sky`: its
/// radiance.
Scene square(const std::string& mtl, const Image& image = Image(1, 1), double sky = 1) {
  const TemporaryFolder folder;
  std::ofstream(folder / "o.obj") << "mtllib o.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
                                     "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";
  std::ofstream(folder / "o.mtl") << "newmtl m\n" << mtl;
  write_image(folder / "image.pfm", image);
  std::ofstream(folder / "s.json")
      << R"({ "camera": { "position": [0, 0, 3], "look_at": [0, 0, 0], "fov": 36.8698976 },
    "environment": { "radiance": [)"
      << sky << ", " << sky << ", " << sky << R"(] }, "meshes": [ { "obj": "o.obj" } ] })";
  return load_scene(folder / "s.json");
}

struct Seen {
  Mean red, green;  ///< of the image
};
Seen seen(const Scene& scene) {
  Seen seen;
  for (const auto& blocks : blocks_of(scene, wavefront_options(side, 16, 1), 12)) {
    Mean red, green;
    for (std::size_t i = 0; i < blocks.size(); i += 3) red.add(blocks[i]), green.add(blocks[i + 1]);
    seen.red.add(red.mean()), seen.green.add(green.mean());
  }
  return seen;
}

/// At 5 sigma: a false alarm once in 10^6 calls, of which there are some ten.
void check_mean(const Mean& mean, double expected, double margin = 1e-4) {
  CHECK(std::abs(mean.mean() - expected) < 5 * mean.error() + margin);
}

}  // namespace

TEST_CASE("what is half there shows half of itself and half of what is behind", "[statistical]") {
  // A cloth of Blender's: its Kd under a coat of 0.04, which makes it a little brighter than Kd.
  const std::string cloth = "Kd .8 .8 .8\nKs .5 .5 .5\nNi 1.45\nNs 250\nillum 9\n";
  const Seen half = seen(square(cloth + "d .5\n"));
  const Seen whole = seen(square("Kd .8 .8 .8\nKs .04 .04 .04\nPr .5\nillum 2\n"));
  check_mean(half.red, 0.5 * whole.red.mean() + 0.5, 3 * whole.red.error());
  CHECK(whole.red.mean() > 0.8);
  CHECK(whole.red.mean() < 0.82);
  check_mean(seen(square("Kd .2 .5 .2\nd .3\n")).red, 0.3 * 0.2 + 0.7);
  check_mean(seen(square("Kd .2 .5 .2\nTr .3\n")).green, 0.7 * 0.5 + 0.3);
}

TEST_CASE("a hole in an image of the coverage shows the sky, whole", "[statistical]") {
  Image holes(8, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) holes.at(x, y) = Vec3f(x >= 2 && x < 6 && y >= 2 && y < 6 ? 0.f : 1.f);
  const Scene scene = square("Kd .2 .5 .2\nmap_d image.pfm\n", holes);
  const Image image = render(scene, wavefront_options(side, 16, 1)).film.image();
  for (int y = 11; y < 21; ++y)
    for (int x = 11; x < 21; ++x) CHECK(image.at(x, y) == Vec3f(1));
  for (const int corner : {1, 30}) CHECK(image.at(corner, corner).x == Approx(0.2).epsilon(1e-3));
}

TEST_CASE("lamps by image shine what the image says", "[statistical]") {
  Image colours(2, 1);
  colours.at(0, 0) = {2, 0.5f, 0}, colours.at(1, 0) = {1, 0.25f, 0};
  for (const std::string ke : {"map_Ke image.pfm\n", "Ke 0 0 0\nmap_Ke image.pfm\n"})
    check_mean(seen(square("Kd 0 0 0\n" + ke, colours, 0)).red, 1.5);
  check_mean(seen(square("Kd 0 0 0\nKe 2 2 2\nmap_Ke image.pfm\n", colours, 0)).green, 0.75);
  check_mean(seen(square("Kd 0 0 0\nmap_Ke image.pfm\nd .5\n", colours, 0)).red, 0.75);
}

TEST_CASE("metal of Blender's has the colour of its base", "[statistical]") {
  // Nine tenths metal: what rough facets lose to one another is a few hundredths.
  const Seen metal = seen(square("Kd .8 .28 .1\nKs .5 .5 .5\nPr .4\nPm .9\nillum 3\n"));
  CHECK(metal.red.mean() > 0.76);
  CHECK(metal.red.mean() < 0.81);
  CHECK(metal.green.mean() == Approx(0.28).margin(0.015));
}
