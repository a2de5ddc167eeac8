// What the statements of an MTL file mean, by the table in docs/scenes.md.
#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <string>

#include "castray/image.h"
#include "castray/scene.h"
#include "materials/texture.h"
#include "temporary_folder.h"

using namespace castray;
using enum SurfaceParameter;

namespace {

/// The material "m" of a file that begins with `first` and says `statements` of it.
struct Read {
  explicit Read(const std::string& statements, const std::string& first = "") {
    const TemporaryFolder folder;
    std::ofstream(folder / "o.obj") << "mtllib o.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    std::ofstream(folder / "o.mtl") << first << "newmtl m\n" << statements;
    Image grey(1, 1), tilted(1, 1), signs(1, 1);
    grey.pixels = {{0.5f, 0.5f, 0.5f}};
    tilted.pixels = {{0.85f, 0.5f, 0.85f}};
    signs.pixels = {{-0.6f, 0, 0.8f}};
    write_image(folder / "grey.pfm", grey);
    write_image(folder / "signs.pfm", signs);
    write_image(folder / "tilted.pfm", tilted);
    scene = load_scene(folder / "o.obj");
  }
  const Material& material() const { return scene.material_of(0); }
  std::string warning() const { return scene.warnings.empty() ? "" : scene.warnings.front().message; }

  Scene scene;
};

Material read(const std::string& statements, const std::string& first = "") {
  return Read(statements, first).material();
}

void check_near(const Vec3d& a, const Vec3d& b) {
  for (int i = 0; i < 3; ++i) CHECK(a[i] == Approx(b[i]).margin(1e-12));
}

const std::string blender = "# Blender 3.6.0 MTL File: 'a.blend'\n";

}  // namespace

TEST_CASE("illum 3 and 5 put a mirror of Ks over Kd") {
  for (const std::string illum : {"illum 3\n", "illum 5\n"}) {
    const Material both = read("Kd .6 .5 .4\nKs .1 .1 .1\nNs 500\n" + illum);
    CHECK(both.type == MaterialType::microfacet);
    check_near(both.kd, {0.6, 0.5, 0.4});
    check_near(both.ks, Vec3d(0.1));
    CHECK(both.alpha == Approx(std::sqrt(2 / 502.0)));
    CHECK(read("Kd .6 .5 .4\nKs .1 .1 .1\nNs 1000\n" + illum).alpha == 0);
    CHECK(read("Kd .6 .5 .4\nKs .1 .1 .1\n" + illum).alpha == 0);
    const Material none = read("Kd .6 .5 .4\nKs 0 0 0\n" + illum);
    CHECK(none.type == MaterialType::diffuse);
    const Material unsaid = read("Kd .6 .5 .4\n" + illum);
    CHECK(unsaid.type == MaterialType::microfacet);
    check_near(unsaid.ks, Vec3d(0.8));
    const Material mirror = read("Kd 0 0 0\nKs .9 .8 .7\nNs 1024\n" + illum);
    CHECK(mirror.type == MaterialType::conductor);
    check_near(mirror.reflectance, {0.9, 0.8, 0.7});
    CHECK(mirror.alpha == 0);
    const Material textured = read("map_Kd grey.pfm\nKs .1 .1 .1\n" + illum);
    CHECK(textured.type == MaterialType::microfacet);
    CHECK(textured.map(kd).used());
  }
  CHECK(read("Kd .5\nKs .5\nNs 100\nillum 1\n").type == MaterialType::diffuse);
  CHECK(read("Kd .5\nKs .5\nNs 100\nillum 2\n").type == MaterialType::microfacet);
}

TEST_CASE("glass is what is meant as glass, and what is partly there is coverage") {
  for (const std::string illum : {"illum 4\n", "illum 6\n", "illum 7\n", "illum 9\n"}) {
    const Material glass = read("Kd .8 .8 .8\nNi 1.5\nNs 200\nTf .9 .8 .7\n" + illum);
    CHECK(glass.type == MaterialType::dielectric);
    CHECK(glass.ior == 1.5);
    CHECK(glass.alpha == 0);
    check_near(glass.transmittance, {0.9, 0.8, 0.7});
    CHECK(glass.coverage == 1);
    const Material cloth = read("Kd .8 .8 .8\nNi 1.45\nd .5\n" + illum);
    CHECK(cloth.type == MaterialType::diffuse);
    CHECK(cloth.coverage == 0.5);
    CHECK(read("Kd .8 .8 .8\nNi 1\n" + illum).type == MaterialType::diffuse);
  }
  CHECK(read("d .3\n").coverage == 0.3);
  CHECK(read("Tr .3\n").coverage == 0.7);
  CHECK(read("d .25\nTr .5\n").coverage == 0.25);
  CHECK(read("d -halo .25\n").coverage == 0.25);
  const Material cut = read("map_d grey.pfm\n");
  CHECK(cut.coverage == 1);
  CHECK(cut.map(coverage).channel == Channel::luminance);
  CHECK(read("map_d -imfchan r grey.pfm\n").map(coverage).channel == Channel::red);
}

TEST_CASE("metalness blends") {
  const Material metal = read("Kd .8 .28 .1\nKs .25 .25 .25\nPr .4\nPm .9\nillum 3\n");
  CHECK(metal.type == MaterialType::principled);
  CHECK(metal.alpha == Approx(0.16));
  CHECK(metal.metallic == 0.9);
  check_near(metal.kd, {0.8, 0.28, 0.1});
  check_near(metal.ks, Vec3d(0.25 * 0.08));
  CHECK(read("Kd .8 .28 .1\nPm 1\n").type == MaterialType::conductor);
  check_near(read("Kd .5\nPm 0\nPr .5\n").ks, Vec3d(0.04));
  const Material textured = read("map_Kd grey.pfm\nPm .5\nPr .5\n");
  CHECK(textured.metallic == 0.5);
  const Material mapped = read("Kd .5\nmap_Pm grey.pfm\nmap_Pr -mm .1 .5 grey.pfm\n");
  CHECK(mapped.metallic == 1);
  CHECK(mapped.map(metallic).used());
  CHECK(read("Kd .5\nmap_Pm lost.pfm\n").metallic == 0);
  CHECK(mapped.alpha == 1);
  CHECK(mapped.map(roughness).base == 0.1f);
  CHECK(mapped.map(roughness).gain == 0.5f);
}

TEST_CASE("Pc, Pcr and Ps are a clear coat and sheen") {
  const Material paint = read("Kd .6 .1 .1\nPr .5\nPm .25\nPs .3\nPc .8\nPcr .2\n");
  CHECK(paint.type == MaterialType::principled);
  CHECK(paint.metallic == 0.25);
  CHECK(paint.sheen == 0.3);
  CHECK(paint.clearcoat == 0.8);
  CHECK(paint.clearcoat_roughness == 0.2);
  check_near(paint.ks, Vec3d(0.04));
  CHECK(read("Kd .6 .1 .1\nPm 1\nPc .8\n").type == MaterialType::principled);
  CHECK(read("Kd .6 .1 .1\nPs .1\n").type == MaterialType::principled);
  CHECK(read("Kd .6 .1 .1\nPs 0\nPc 0\nPcr .03\n").type == MaterialType::diffuse);
}

TEST_CASE("map_Pc, map_Pcr and map_Ps are images of a clear coat, its roughness and sheen") {
  const Material paint = read("Kd .5\nPc .8\nmap_Pc grey.pfm\nPcr 0\nmap_Pcr -mm .1 .5 grey.pfm\n");
  CHECK(paint.type == MaterialType::principled);
  CHECK(paint.map(clearcoat).used());
  CHECK(paint.clearcoat == 0.8);
  CHECK(paint.map(clearcoat_roughness).base == 0.1f);
  CHECK(paint.clearcoat_roughness == 1);  // 0 would hide the image
  CHECK(!paint.map(sheen).used());
  const Material cloth = read("Kd .5\nPm 1\nmap_Ps grey.pfm\n");
  CHECK(cloth.type == MaterialType::principled);
  CHECK(cloth.map(sheen).used());
  CHECK(cloth.sheen == 1);
  CHECK(read("Kd .5\nmap_Pcr grey.pfm\n").type == MaterialType::diffuse);
}

TEST_CASE("files of Blender are read by its own convention") {
  const Material material = read("Ns 250\nKd .5\nKs .5 .5 .5\nNi 1.45\nd 1\nillum 2\n", blender);
  CHECK(material.type == MaterialType::microfacet);
  CHECK(material.alpha == Approx(0.25));  // roughness 0.5
  check_near(material.ks, Vec3d(0.04));
  CHECK(read("Kd .5\nNs 0\n", blender).alpha == 1);
  CHECK(read("Kd .5\nNs 1000\n", blender).alpha == 0);
  // A half transparent cloth, by illum 9 even without the comment.
  const Material cloth = read("Kd .8 .8 .8\nKs .5 .5 .5\nNi 1.45\nNs 250\nd .5\nillum 9\n");
  CHECK(cloth.coverage == 0.5);
  check_near(cloth.ks, Vec3d(0.04));
  const Material glass = read("Kd .9 .8 .7\nNi 1.45\nPr .2\nPm 0\nTf 1 1 1\nillum 2\n", blender);
  CHECK(glass.type == MaterialType::dielectric);
  check_near(glass.transmittance, {0.9, 0.8, 0.7});
  CHECK(glass.alpha == Approx(0.04));
  check_near(read("Kd .8 .8 .8\nmap_Kd grey.pfm\n", blender).kd, Vec3d(1));
  check_near(read("Kd .8 .8 .8\nmap_Kd grey.pfm\n").kd, Vec3d(0.8));
}

TEST_CASE("images alone, or beside black, are taken as they are") {
  check_near(read("map_Kd grey.pfm\n").kd, Vec3d(1));
  check_near(read("Kd 0 0 0\nmap_Kd grey.pfm\n").kd, Vec3d(1));
  for (const std::string statements : {"map_Ke grey.pfm\n", "Ke 0 0 0\nmap_Ke grey.pfm\n"}) {
    const Read lamp(statements);
    check_near(lamp.material().ke, Vec3d(1));
    CHECK(lamp.material().map(ke).used());
    CHECK(lamp.scene.lights.size() == 1);
  }
  check_near(read("Ke 2 3 4\nmap_Ke grey.pfm\n").ke, {2, 3, 4});
  check_near(read("Ke 2 3 4\nmap_Ke lost.pfm\n").ke, {2, 3, 4});
  CHECK(Read("map_Ke lost.pfm\n").scene.lights.empty());
  check_near(read("Ns 10\nmap_Ks grey.pfm\n").ks, Vec3d(1));
}

TEST_CASE("bump maps are of heights where they are grey, of normals where they are coloured") {
  CHECK(read("norm -bm .5 tilted.pfm\n").map(normal).gain == 0.5f);
  for (const std::string key : {"bump", "map_Bump", "map_bump"}) {
    const Material tilted = read(key + " -bm .5 tilted.pfm\n");
    CHECK(tilted.map(normal).used());
    CHECK(!tilted.map(bump).used());
    CHECK(tilted.map(normal).gain == 0.5f);
    const Material grey = read(key + " -bm .5 -mm 0 2 grey.pfm\n");
    CHECK(grey.map(bump).used());
    CHECK(!grey.map(normal).used());
    CHECK(grey.map(bump).gain == 1);
  }
}

TEST_CASE("normals of either sign, as float images hold them, are read as what they are") {
  for (const std::string key : {"norm", "map_Bump"}) {
    const Read signs(key + " signs.pfm\n");
    const TextureMap& map = signs.material().map(normal);
    REQUIRE(map.used());
    CHECK(!signs.material().map(bump).used());
    const Vec3d n = map_normal(signs.scene.textures[static_cast<std::size_t>(map.texture)], map, 0.5, 0.5);
    for (int c = 0; c < 3; ++c) CHECK(n[c] == Approx(Vec3d{-0.6, 0, 0.8}[c]).margin(1e-6));
  }
  CHECK_THROWS_WITH(Read("map_Kd signs.pfm\n"), Catch::Contains("o.mtl:2") && Catch::Contains("at least 0"));
}

TEST_CASE("an image of the exponent of a highlight is one of roughness") {
  const auto roughness_of = [](const Read& read) {
    const TextureMap& map = read.material().map(roughness);
    REQUIRE(map.used());
    CHECK(read.material().alpha == 1);
    return map_number(read.scene.textures[static_cast<std::size_t>(map.texture)], map, 0.5, 0.5);
  };
  const double half_step = 0.5 / 255;
  const auto of_exponent = [=](double ns) {
    return Approx(std::sqrt(std::sqrt(2 / (ns + 2)))).margin(half_step);
  };
  const Read half("Ks .5 .5 .5\nNs 200\nmap_Ns grey.pfm\n");
  CHECK(half.material().type == MaterialType::microfacet);
  CHECK(roughness_of(half) == of_exponent(100));
  CHECK(roughness_of(Read("Ks .5\nNs 200\nmap_Ns -mm .1 1 grey.pfm\n")) == of_exponent(120));
  CHECK(roughness_of(Read("Ks .5\nmap_Ns grey.pfm\n")) == of_exponent(500));
  CHECK(roughness_of(Read("Ks .5\nNs 200\nmap_Ns grey.pfm\n", blender)) == Approx(0.5));
  CHECK(Read("Ks .5\nPr .5\nmap_Ns grey.pfm\n").material().alpha == 0.25);
  CHECK(Read("Ns 200\nillum 7\nNi 1.5\nmap_Ns grey.pfm\n").material().map(roughness).used() == false);
  CHECK(Read("Ks .5\nmap_Ns grey.pfm\n").scene.textures.size() == 1);
}

TEST_CASE("options of images") {
  const TextureMap map = read("map_Kd -s 2 3 1 -o .5 .25 -clamp on -mm .1 .9 -imfchan g grey.pfm\n").map(kd);
  CHECK(map.scale == std::array<float, 2>{2, 3});
  CHECK(map.offset == std::array<float, 2>{0.5f, 0.25f});
  CHECK(map.clamp);
  CHECK(map.base == 0.1f);
  CHECK(map.gain == 0.9f);
  CHECK(map.channel == Channel::green);
}

TEST_CASE("aniso of a metal is the ratio of its lobe's widths, anisor a share of a turn") {
  Read read("Pm 1\nPr .5\naniso .5\nanisor .25\n");
  CHECK(read.warning().empty());
  CHECK(read.material().type == MaterialType::conductor);
  CHECK(read.material().anisotropy == 0.45);
  CHECK(read.material().anisotropy_rotation == 90);
  CHECK(Read("Pm 1\nanisor .5\n").material().anisotropy == 0);
  Read layered("Pm .5\nPr .5\nPc 1\naniso .5\n");
  CHECK(layered.warning().empty());
  CHECK(layered.material().type == MaterialType::principled);
  CHECK(layered.material().anisotropy == 0.45);

  Read mapped("Pm 1\nPr .5\nanisor .25\nmap_aniso grey.pfm\nmap_anisor -imfchan r grey.pfm\n");
  CHECK(mapped.material().map(anisotropy).used());
  CHECK(mapped.material().anisotropy == 0.9);
  CHECK(mapped.material().map(anisotropy_rotation).channel == Channel::red);
  CHECK(mapped.material().anisotropy_rotation == 90);
}

TEST_CASE("what is not done and would be seen is told") {
  const std::string needs_layers =
      "aniso is done for metals, and for what has Pm, Ps or Pc and neither Ke nor an image of its roughness";
  CHECK(Read("aniso .5\n").warning() == needs_layers);
  CHECK(Read("Pm .5\nKe 1 1 1\naniso .5\n").warning() == needs_layers);
  CHECK(Read("map_aniso grey.pfm\n").warning() == needs_layers);
  CHECK(Read("Pc 0\nPs 0\naniso 0\nPcr .03\nKa 1 1 1\nsharpness 60\n").warning().empty());
  CHECK(Read("disp grey.pfm\n").warning() == "disp is not done");
}
