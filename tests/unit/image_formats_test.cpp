#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "castray/film.h"
#include "castray/image.h"
#include "temporary_folder.h"
#include "test_image.h"

using namespace castray;

namespace {

const std::filesystem::path golden = CASTRAY_ROOT "/tests/golden/images";

float radiance_at(int x, int y, int c) { return static_cast<float>((7 * x + 11 * y + 5 * c) % 97) / 32; }

float encoded_at(int x, int y, int c, int bits) {
  return static_cast<float>((257 * x + 4099 * y + 17 * c) % (1 << bits)) /
         static_cast<float>((1 << bits) - 1);
}

/// The greatest difference from expected(x, y, c).
template <class F>
float worst(const Image& image, F expected) {
  float greatest = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c)
        greatest = std::max(greatest, std::abs(image.at(x, y)[c] - expected(x, y, c)));
  return greatest;
}

}  // namespace

TEST_CASE("files of OpenEXR, OpenCV and Pillow are read") {
  for (const char* name :
       {"half.exr", "half_tiled.exr", "float.exr", "float_tiled.exr", "float.pfm", "float.hdr"}) {
    INFO(name);
    const ImageFile file = read_image(golden / name);
    CHECK_FALSE(file.encoded);
    REQUIRE((file.image.width == 21 && file.image.height == 13));
    CHECK(worst(file.image, radiance_at) <= (name == std::string("float.hdr") ? 3.1f / 128 : 0.f));
  }
  for (const int bits : {8, 16})
    for (const char* suffix : {".png", ".ppm"}) {
      INFO(bits << suffix);
      const ImageFile file = read_image(golden / (std::to_string(bits) + suffix));
      CHECK(file.encoded);
      REQUIRE((file.image.width == 21 && file.image.height == 13));
      CHECK(worst(file.image, [&](int x, int y, int c) { return encoded_at(x, y, c, bits); }) == 0);
    }
  const Image palette = read_image(golden / "palette.png").image;
  CHECK(palette.at(1, 0) == Vec3f(1, 0, 0));  // entry 257 mod 4
  CHECK(palette.at(3, 0) == Vec3f(10, 20, 30) / 255.f);
}

TEST_CASE("variances of an EXR file are read and written") {
  const ImageFile file = read_image(golden / "float.exr");
  REQUIRE(file.noise);
  CHECK(file.noise->freedom == 15);
  CHECK(worst(file.noise->variance, [](int x, int y, int c) { return radiance_at(x, y, c) / 4; }) == 0);
  CHECK_FALSE(read_image(golden / "half.exr").noise);
  CHECK(file.metadata.at("owner") == "OpenEXR");

  const TemporaryFolder folder;
  write_image(folder / "a.exr", file.image, {}, file.metadata, file.noise);
  const ImageFile back = read_image(folder / "a.exr");
  REQUIRE(back.noise);
  CHECK(back.noise->freedom == 15);
  CHECK(back.noise->variance.pixels == file.noise->variance.pixels);
  write_image(folder / "a.exr", file.image, {}, {}, Noise{file.image});
  CHECK(std::isinf(read_image(folder / "a.exr").noise->freedom));
}

TEST_CASE("the header of a PFM or PPM file may end in CR LF") {
  const float pixel[] = {1, 2, 3};
  std::string bytes = "PF\r\n1 1\r\n-1.0\r\n";
  bytes.append(reinterpret_cast<const char*>(pixel), sizeof pixel);
  CHECK(parse_raster("a.pfm", bytes).floats == std::vector<float>{1, 2, 3});
  CHECK(parse_raster("a.ppm", "P6\r\n1 1\r\n255\r\nabc").bytes == std::vector<unsigned char>{'a', 'b', 'c'});
  CHECK(parse_raster("a.ppm", "P6 1 1 255\nabc").bytes == std::vector<unsigned char>{'a', 'b', 'c'});
}

TEST_CASE("variances of a PFM file are in the file beside it, and exact") {
  const TemporaryFolder folder;
  write_image(folder / "a.pfm", test_image(4, 3));
  CHECK_FALSE(read_image(folder / "a.pfm").noise);
  write_image(folder / "a.variance.pfm", test_image(4, 3, 2));
  const ImageFile file = read_image(folder / "a.pfm");
  REQUIRE(file.noise);
  CHECK(file.noise->variance.pixels == test_image(4, 3, 2).pixels);
  CHECK(std::isinf(file.noise->freedom));
}

TEST_CASE("16 bits a value: PNG and PPM to half a step, EXR as half floats that stay finite") {
  const TemporaryFolder folder;
  Image image = test_image(9, 5);
  const Display display{{}, -2, true};
  for (const char* name : {"a.png", "a.ppm"}) {
    write_image(folder / name, image, display);
    const Image expected = displayed(image, display);
    CHECK(worst(read_image(folder / name).image, [&](int x, int y, int c) { return expected.at(x, y)[c]; }) <=
          0.501f / 65535);
  }
  image.at(0, 0) = {1e9f, -1e9f, 1};
  image.at(1, 0).x = std::numeric_limits<float>::infinity();
  write_image(folder / "a.exr", image, display);
  const Image back = read_image(folder / "a.exr").image;
  CHECK(back.at(0, 0) == Vec3f(65504, -65504, 1));
  CHECK(std::isinf(back.at(1, 0).x));
  for (std::size_t i = 2; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) CHECK(back.pixels[i][c] == Approx(image.pixels[i][c]).epsilon(0x1p-11));
}

TEST_CASE("metadata under names that OpenEXR uses itself is left out") {
  const TemporaryFolder folder;
  write_image(
      folder / "a.exr", test_image(2, 2), {},
      {{"channels", "x"}, {"compression", "x"}, {"chunkCount", "x"}, {"tiles", "x"}, {"note", "kept"}});
  const Metadata metadata = read_image(folder / "a.exr").metadata;
  CHECK(metadata.at("note") == "kept");
  CHECK(metadata.count("channels") == 0);
}
