#include "image/exr_layers.h"

#include <ImfRgbaFile.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "castray/image.h"
#include "core/files.h"
#include "exr_file.h"
#include "temporary_folder.h"
#include "test_image.h"

using namespace castray;
using Catch::Contains;

namespace {

const std::filesystem::path golden = CASTRAY_ROOT "/tests/golden/images";

ImageFile read_parts(const std::vector<TestPart>& parts, const std::string& layer = "") {
  const TemporaryFolder folder;
  write_exr_parts(folder / "a.exr", parts);
  return read_image(folder / "a.exr", layer);
}

/// The colour of all pixels of a file of one part.
Vec3f colour_of(const std::map<std::string, float>& channels, const std::string& layer = "") {
  return read_parts({{channels}}, layer).image.at(3, 2);
}

std::map<std::string, float> colours(const std::string& prefix, float red) {
  return {{prefix + "R", red}, {prefix + "G", red + 1}, {prefix + "B", red + 2}};
}

std::map<std::string, float> joined(std::map<std::string, float> a, const std::map<std::string, float>& b) {
  a.insert(b.begin(), b.end());
  return a;
}

}  // namespace

TEST_CASE("EXR: colours, a layer's colours, vectors, grey, a single channel of any name") {
  CHECK(colour_of(colours("", 1)) == Vec3f(1, 2, 3));
  CHECK(colour_of({{"r", 1}, {"g", 2}, {"b", 3}}) == Vec3f(1, 2, 3));
  CHECK(colour_of(colours("ViewLayer.Combined.", 4)) == Vec3f(4, 5, 6));
  CHECK(colour_of({{"X", 1}, {"Y", 2}, {"Z", 3}}) == Vec3f(1, 2, 3));
  CHECK(colour_of({{"normal.X", -1}, {"normal.Y", 2}, {"normal.Z", 3}}) == Vec3f(-1, 2, 3));
  CHECK(colour_of({{"Y", 7}}) == Vec3f(7));
  CHECK(colour_of({{"G", 7}}) == Vec3f(7));
  CHECK(colour_of({{"depth.V", 7}}) == Vec3f(7));
}

TEST_CASE("EXR: which of several layers is read without --layer, and what is said of the others") {
  const ImageFile beside = read_parts({{joined(colours("", 1), {{"Z", 9}, {"diffuse.R", 3}})}});
  CHECK(beside.image.at(0, 0) == Vec3f(1, 2, 3));
  CHECK(beside.left_out == std::vector<std::string>{"layer Z (Z)", "layer diffuse (R)"});
  TestPart wide{colours("", 1)};
  wide.wide_gamut = true;
  CHECK(read_parts({wide}).left_out == std::vector<std::string>{"that its primaries are not those of sRGB"});
  const auto blender = joined(colours("ViewLayer.Combined.", 1), {{"ViewLayer.Depth.Z", 9}});
  CHECK(colour_of(blender) == Vec3f(1, 2, 3));
  CHECK(colour_of(blender, "ViewLayer.Depth") == Vec3f(9));
  CHECK(colour_of(blender, "ViewLayer.Combined") == Vec3f(1, 2, 3));
  const auto two = joined(colours("a.", 1), colours("b.c.", 4));
  CHECK_THROWS_WITH(colour_of(two), Contains("--layer NAME: a (R G B), b.c (R G B)"));
  CHECK(colour_of(two, "b.c") == Vec3f(4, 5, 6));
  CHECK_THROWS_WITH(colour_of(two, "b"), Contains("no layer 'b'; its layers are a (R G B), b.c (R G B)"));
  CHECK_THROWS_WITH(colour_of({{"U", 1}, {"V", 2}}), Contains("several layers") && Contains("U (U), V (V)"));
  CHECK(colour_of({{"U", 1}, {"V", 2}}, "V") == Vec3f(2));
}

TEST_CASE("EXR: a file whose only picture has no layer's name is read whatever layer is asked for") {
  CHECK(colour_of(colours("", 1), "ViewLayer.Combined") == Vec3f(1, 2, 3));
  CHECK(colour_of(joined(colours("", 1), colours("variance.", 0)), "x") == Vec3f(1, 2, 3));
  CHECK_THROWS_WITH(colour_of(joined(colours("", 1), {{"Z", 1}}), "x"), Contains("no layer 'x'"));
}

TEST_CASE("EXR: of several parts the first is read, or the layer of a name") {
  TestPart beauty{colours("", 1)}, depth{{{"Z", 9}}}, light{colours("", 4)};
  beauty.name = "beauty", depth.name = "depth", light.name = "light";
  const ImageFile first = read_parts({beauty, depth, light});
  CHECK(first.image.at(0, 0) == Vec3f(1, 2, 3));
  CHECK(first.left_out == std::vector<std::string>{"layer depth (Z)", "layer light (R G B)"});
  CHECK(read_parts({beauty, depth, light}, "light").image.at(0, 0) == Vec3f(4, 5, 6));
  CHECK(read_parts({beauty, depth, light}, "depth").image.at(0, 0) == Vec3f(9));
  TestPart left{colours("diffuse.", 1)}, right{colours("diffuse.", 4)};
  left.name = "left", right.name = "right";
  CHECK(read_parts({left, right}).image.at(0, 0) == Vec3f(1, 2, 3));
  CHECK(read_parts({left, right}, "right.diffuse").image.at(0, 0) == Vec3f(4, 5, 6));
}

TEST_CASE("EXR: alpha stands apart, and is left away where it is 1 everywhere") {
  const ImageFile half = read_parts({{joined(colours("", 1), {{"A", .5f}})}});
  CHECK(half.image.at(0, 0) == Vec3f(1, 2, 3));
  CHECK(half.alpha == std::vector<float>(12, .5f));
  CHECK(read_parts({{joined(colours("a.", 1), {{"a.A", 1}})}}).alpha.empty());
  CHECK(read_parts({{{{"Y", 1}, {"A", .25f}}}}).alpha == std::vector<float>(12, .25f));
}

TEST_CASE("EXR: the display window is the picture, black where the file has no data") {
  TestPart part{colours("", 1)};
  part.data = {{1, 1}, {2, 1}};
  const ImageFile cropped = read_parts({part});
  REQUIRE((cropped.image.width == 4 && cropped.image.height == 3));
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      CHECK(cropped.image.at(x, y) == (y == 1 && x >= 1 && x <= 2 ? Vec3f(1, 2, 3) : Vec3f(0)));
  CHECK(cropped.left_out.empty());
  part.data = {{-1, -5}, {1, 0}};
  const ImageFile overscan = read_parts({part});
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x) CHECK((overscan.image.at(x, y) == Vec3f(0)) == (y > 0 || x > 1));
  CHECK(overscan.left_out == std::vector<std::string>{"pixels outside its display window"});
  part.display = {{-2, -2}, {1, 0}}, part.data = part.display;
  CHECK(read_parts({part}).image.at(3, 2) == Vec3f(1, 2, 3));
  part.data = {{10, 10}, {12, 12}};
  CHECK_THROWS_WITH(read_parts({part}), Contains("outside its display window"));
  part.display = {{0, 0}, {99999, 99999}};
  CHECK_THROWS_WITH(read_parts({part}), Contains("more than 2^28 pixels"));
  part.display = {{0, 0}, {7999, 7999}};
  CHECK_THROWS_WITH(read_parts({part}), Contains("too short for its size"));
}

TEST_CASE("EXR: luminance and chroma become red, green and blue") {
  const TemporaryFolder folder;
  constexpr int size = 64, filter_reach = 14;
  const auto colour_at = [](int x, int y) {  // smooth: chroma is stored at half the resolution
    const auto u = static_cast<float>(x) / size, v = static_cast<float>(y) / size;
    return Vec3f(1 + u, 1 + v, 2 - .5f * u);
  };
  std::vector<Imf::Rgba> pixels;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Vec3f colour = colour_at(x, y);
      pixels.emplace_back(colour.x, colour.y, colour.z, 1.f);
    }
  const auto write = [&](Imf::RgbaChannels channels) {
    Imf::RgbaOutputFile out((folder / "a.exr").c_str(), size, size, channels);
    out.setYCRounding(10, 10);  // all digits of a half
    out.setFrameBuffer(pixels.data(), 1, size);
    out.writePixels(size);
  };
  write(Imf::WRITE_YC);
  const ImageFile file = read_image(folder / "a.exr");
  CHECK(file.left_out.empty());
  float worst = 0;
  for (int y = filter_reach; y < size - filter_reach; ++y)
    for (int x = filter_reach; x < size - filter_reach; ++x)
      for (int c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(file.image.at(x, y)[c] - colour_at(x, y)[c]));
  CHECK(worst < .004f);  // steps of halves between 1 and 2 are .001; three are added up
  write(Imf::WRITE_Y);
  const Vec3f grey = read_image(folder / "a.exr").image.at(0, 0);
  CHECK(grey.x == Approx(.2126 * 1 + .7152 * 1 + .0722 * 2).epsilon(.001));
  CHECK((grey.x == grey.y && grey.y == grey.z));
  CHECK_THROWS_WITH(colour_of({{"Y", 1}, {"RY", 0}, {"BY", 0}}), Contains("not half floats"));
}

TEST_CASE(
    "EXR files of a compositor: autocropped is equal, shifted is not, a layer is found, vectors are whole") {
  const Image full = read_image(golden / "full.exr").image;
  CHECK(read_image(golden / "autocrop.exr").image.pixels == full.pixels);
  CHECK(read_image(golden / "shifted.exr").image.pixels != full.pixels);
  CHECK(read_image(golden / "layer.exr").image.pixels == read_image(golden / "plain.exr").image.pixels);
  const Image a = read_image(golden / "xyz_a.exr").image, b = read_image(golden / "xyz_b.exr").image;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const Vec3f difference = b.pixels[i] - a.pixels[i];
    CHECK(difference.x == Approx(5));
    CHECK(difference.y == 0);
    CHECK(difference.z == Approx(5));
  }
}
