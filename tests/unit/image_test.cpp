#include "castray/image.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "castray/error.h"
#include "core/files.h"
#include "temporary_folder.h"
#include "test_image.h"

using namespace castray;

namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

/// A file of these bytes, read.
ImageFile read_bytes(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  write_file(folder / name, bytes);
  return read_image(folder / name);
}

}  // namespace

TEST_CASE("float formats give back every bit, with metadata in EXR") {
  const TemporaryFolder folder;
  const auto [width, height] = GENERATE(std::pair(1, 1), std::pair(7, 3), std::pair(64, 33));
  Image image = test_image(width, height);
  image.at(0, 0) = {-1.5f, 1e30f, 1e-30f};
  for (const char* name : {"a.pfm", "a.exr"}) {
    write_image(folder / name, image, {}, {{"scene", "box"}, {"spp", "64"}});
    const ImageFile file = read_image(folder / name);
    CHECK_FALSE(file.encoded);
    CHECK(file.image.width == width);
    CHECK(file.image.pixels == image.pixels);
  }
  CHECK(read_image(folder / "a.exr").metadata == Metadata{{"scene", "box"}, {"spp", "64"}});
}

TEST_CASE("PFM is little-endian, bottom row first, the other byte order and grey are read") {
  const TemporaryFolder folder;
  Image image(1, 2);
  image.at(0, 0) = {1, 2, 3};
  image.at(0, 1) = {4, 5, 6};
  write_image(folder / "a.pfm", image);
  CHECK(read_file(folder / "a.pfm") == std::string("PF\n1 2\n-1.0\n\0\0\x80\x40\0\0\xa0\x40\0\0\xc0\x40"
                                                   "\0\0\x80\x3f\0\0\0\x40\0\0\x40\x40",
                                                   36));
  const ImageFile big = read_bytes("b.pfm", std::string("Pf\n1 1\n1.0\n\x40\xa0\0\0", 15));
  CHECK(big.image.at(0, 0) == Vec3f(5));
}

TEST_CASE("HDR keeps 8 bits of the greatest component and stores NaN and negative as 0") {
  const TemporaryFolder folder;
  Image image = test_image(40, 9);
  write_image(folder / "a.hdr", image);
  const Image back = read_image(folder / "a.hdr").image;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      CHECK(std::abs(back.pixels[i][c] - image.pixels[i][c]) <= max_component(image.pixels[i]) / 128);
  image.at(0, 0) = {not_a_number, -1, 1};
  write_image(folder / "a.hdr", image);
  CHECK(read_image(folder / "a.hdr").image.at(0, 0) == Vec3f(0, 0, 1));
}

TEST_CASE("8-bit formats store the displayed value to half a step, with metadata in PNG") {
  const TemporaryFolder folder;
  const Image image = test_image(33, 5);
  const Display display{parse_tone_curve(GENERATE("srgb", "linear", "gamma:0.6")), -2};
  const Metadata metadata{{"scene", "box"}, {"note", "caf\xc3\xa9"}};
  for (const char* name : {"a.ppm", "a.png"}) {
    write_image(folder / name, image, display, metadata);
    const ImageFile file = read_image(folder / name);
    CHECK(file.encoded);
    const Image expected = displayed(image, display);
    float worst = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(file.image.pixels[i][c] - expected.pixels[i][c]));
    CHECK(worst <= 0.5001f / 255);
  }
  CHECK(read_image(folder / "a.png").metadata == metadata);
}

TEST_CASE("every 8-bit value survives reading, decoding and writing") {
  const TemporaryFolder folder;
  const ToneCurve tone = parse_tone_curve(GENERATE("srgb", "linear", "gamma:0.6"));
  std::string bytes = "P6 # comment\n256 1\n255\n";
  for (int v = 0; v < 256; ++v) bytes += std::string(3, static_cast<char>(v));
  write_image(folder / "b.png", decoded(read_bytes("a.ppm", bytes), tone), {tone, 0});
  const Image back = read_image(folder / "b.png").image;
  for (int v = 0; v < 256; ++v) CHECK(std::lround(255 * back.at(v, 0).y) == v);
}

TEST_CASE("NaN is shown black, not white, infinities at the ends") {
  const Image image = [] {
    Image made(1, 1);
    made.at(0, 0) = {not_a_number, infinity, -infinity};
    return made;
  }();
  CHECK(displayed(image, {}).at(0, 0) == Vec3f(0, 1, 0));
  CHECK(count_nonfinite(image) == 1);
}

TEST_CASE("tone curves have their defining values, and names that cannot be are refused") {
  CHECK(ToneCurve{}.encode(0.5) == Approx(0.7353569831));
  CHECK(ToneCurve{}.encode(0.002) == Approx(0.02584));
  CHECK(parse_tone_curve("gamma:0.6").encode(0.5) == Approx(0.6597539554));
  for (const char* text : {"srgb", "linear", "gamma:0.6"}) CHECK(to_string(parse_tone_curve(text)) == text);
  for (const char* text : {"", "sRGB", "gamma", "gamma:", "gamma:0", "gamma:-1", "gamma:nan", "gamma:1x"})
    CHECK_THROWS_WITH(parse_tone_curve(text), Catch::Contains("use srgb, linear, or gamma:G"));
}

TEST_CASE("PPM of 16 bits and of text is read") {
  const ImageFile wide = read_bytes("a.ppm", std::string("P6\n1 1\n65535\n\x80\0\xff\xff\0\0", 19));
  CHECK(wide.image.at(0, 0) == Vec3f(32768.f / 65535.f, 1, 0));
  const ImageFile text = read_bytes("a.ppm", "P3 1 2 10\n0 5 10\n10 # half\n0 1");
  CHECK(text.image.at(0, 0) == Vec3f(0, .5f, 1));
  CHECK(text.image.at(0, 1) == Vec3f(1, 0, .1f));
}

TEST_CASE("files that are cut, forged or of another kind give one clear line") {
  const TemporaryFolder folder;
  const Image image = test_image(20, 20);
  for (const std::string name : {"a.ppm", "a.png", "a.pfm", "a.hdr", "a.exr"}) {
    write_image(folder / name, image);
    const std::string whole = read_file(folder / name);
    for (const double part : {0.0, 0.01, 0.1, 0.5, 0.99}) {
      write_file(folder / name,
                 whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
      CHECK_THROWS_AS(read_image(folder / name), InputError);
    }
    write_file(folder / name, "something else entirely\n");
    CHECK_THROWS_WITH(read_image(folder / name), Catch::StartsWith((folder / name).string() + ": "));
  }
  CHECK_THROWS_WITH(read_bytes("a.pfm", "PF\n16000000 16000000\n-1\n"), Catch::Contains("2^28"));
  CHECK_THROWS_WITH(read_bytes("a.pfm", "PF\n16000 16000\n-1\n"), Catch::Contains("too short"));
  CHECK_THROWS_WITH(read_bytes("a.pfm", "PF\n0 1\n-1\n"), Catch::Contains("bad width '0'"));
  CHECK_THROWS_WITH(read_bytes("a.ppm", "P6\n99999999999 1\n255\n"), Catch::Contains("bad width"));
  CHECK_THROWS_WITH(read_bytes("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 16000\n"),
                    Catch::Contains("too short"));
}

TEST_CASE("an unknown suffix lists the known ones") {
  for (const char* name : {"a.tif", "a", ".png"})
    CHECK_THROWS_WITH(check_output_image(name), Catch::Contains(".ppm .png .pfm .hdr .exr .film"));
  CHECK_NOTHROW(check_output_image("A.PNG"));
  CHECK_THROWS_WITH(write_image("a.film", test_image(1, 1)), Catch::Contains("another format"));
}
