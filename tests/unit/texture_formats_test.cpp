#include <stb/stb_image_write.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "castray/error.h"
#include "castray/image.h"
#include "core/files.h"
#include "materials/texture.h"
#include "small_files.h"
#include "temporary_folder.h"

using namespace castray;
using Catch::Contains;

namespace {

Raster raster_of(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  write_file(folder / name, bytes);
  return read_raster(folder / name);
}

std::string text(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

using Bytes = std::vector<unsigned char>;

/// Smooth, so that JPEG keeps it; with alpha, where asked for.
Bytes gradient(int width, int height, int channels) {
  Bytes bytes;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c)
        bytes.push_back(static_cast<unsigned char>(40 + 3 * x + (c % 2 ? 2 * y : y) + 20 * c));
  return bytes;
}

std::string written(const char* kind, int width, int height, int channels, const Bytes& pixels) {
  std::string bytes;
  const auto append = [](void* to, void* from, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(from), static_cast<std::size_t>(size));
  };
  const std::string format = kind;
  if (format == "jpg") stbi_write_jpg_to_func(append, &bytes, width, height, channels, pixels.data(), 100);
  if (format == "tga") stbi_write_tga_to_func(append, &bytes, width, height, channels, pixels.data());
  if (format == "bmp") stbi_write_bmp_to_func(append, &bytes, width, height, channels, pixels.data());
  if (format == "png") stbi_write_png_to_func(append, &bytes, width, height, channels, pixels.data(), 0);
  return bytes;
}

}  // namespace

TEST_CASE("textures of 8 bits are read as bytes: TGA, BMP and PNG exactly, JPEG nearly") {
  struct Case {
    const char* kind;
    int channels, worst;
  };
  const auto [kind, channels, worst] =
      GENERATE(Case{"jpg", 3, 3}, Case{"jpg", 1, 3}, Case{"tga", 1, 0}, Case{"tga", 3, 0}, Case{"tga", 4, 0},
               Case{"bmp", 3, 0}, Case{"bmp", 4, 0}, Case{"png", 1, 0}, Case{"png", 2, 0}, Case{"png", 3, 0},
               Case{"png", 4, 0});
  INFO(kind << " of " << channels);
  const Bytes pixels = gradient(21, 13, channels);
  const Raster raster = raster_of(std::string("a.") + kind, written(kind, 21, 13, channels, pixels));
  CHECK((raster.width == 21 && raster.height == 13));
  CHECK(raster.encoded);
  CHECK(raster.floats.empty());
  const int kept = std::string(kind) == "jpg" && channels == 1 ? 3 : channels;  // stb writes grey JPEG as RGB
  REQUIRE(raster.channels == kept);
  REQUIRE(raster.bytes.size() == 21u * 13u * static_cast<unsigned>(kept));
  int greatest = 0;
  for (std::size_t i = 0; i < raster.bytes.size(); ++i) {
    const std::size_t from = kept == channels ? i : i / 3;
    greatest = std::max(greatest, std::abs(int(raster.bytes[i]) - int(pixels[from])));
  }
  CHECK(greatest <= worst);
}

TEST_CASE("a JPEG of another program: red, green, blue and grey quarters") {
  const Raster jpeg = read_raster(CASTRAY_ROOT "/tests/golden/images/four_colours.jpg");
  REQUIRE((jpeg.width == 64 && jpeg.height == 64 && jpeg.channels == 3));
  const auto at = [&](std::size_t x, std::size_t y, std::size_t c) {
    return int(jpeg.bytes[3 * (64 * y + x) + c]);
  };
  const std::pair<std::size_t, std::size_t> middles[] = {
      {16, 16}, {48, 16}, {16, 48}};  // of red, green, blue
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(std::abs(at(middles[k].first, middles[k].second, c) - (c == k ? 255 : 0)) <= 2);
  CHECK((at(48, 48, 0) > 150 && at(48, 48, 0) == at(48, 48, 1) && at(48, 48, 0) == at(48, 48, 2)));
}

TEST_CASE("PNG of every colour type and depth") {
  CHECK(raster_of("a.png", png_file(2, 1, 0, {text({0x40})})).bytes == Bytes{0, 255});
  CHECK(raster_of("a.png", png_file(2, 4, 0, {text({0x5f})})).bytes == Bytes{0x55, 0xff});
  CHECK(raster_of("a.png", png_file(1, 8, 6, {text({1, 2, 3, 4})})).bytes == Bytes{1, 2, 3, 4});
  CHECK(raster_of("a.png", png_file(1, 8, 6, {text({1, 2, 3, 255})})).bytes == Bytes{1, 2, 3});
  CHECK(raster_of("a.png", png_file(1, 8, 4, {text({9, 100})})).bytes == Bytes{9, 100});

  const std::string palette = png_chunk("PLTE" + text({1, 2, 3, 4, 5, 6}));
  const Raster coloured = raster_of("a.png", png_file(2, 1, 3, {text({0x40})}, palette));
  CHECK(coloured.bytes == Bytes{1, 2, 3, 4, 5, 6});
  const Raster clear =
      raster_of("a.png", png_file(2, 1, 3, {text({0x40})}, palette + png_chunk("tRNS" + text({0, 128}))));
  CHECK(clear.channels == 4);
  CHECK(clear.bytes == Bytes{1, 2, 3, 0, 4, 5, 6, 128});

  const Raster deep = raster_of("a.png", png_file(1, 16, 4, {text({0x80, 0, 0x40, 0})}));
  CHECK(deep.bytes.empty());
  CHECK(deep.channels == 2);
  CHECK(deep.floats == std::vector<float>{32768.f / 65535.f, 16384.f / 65535.f});
  CHECK(raster_of("a.png", png_file(1, 16, 0, {text({0xff, 0xff})})).floats == std::vector<float>{1});
}

TEST_CASE("GIF gives its first frame, with what is transparent") {
  const std::string palette = text({0, 0, 0, 255, 0, 0, 0, 255, 0, 10, 20, 30});
  const std::string first = text({0, 1, 2, 3, 1, 1}), second = text({3, 3, 3, 3, 3, 3});
  const Raster opaque = raster_of("a.gif", gif_file(3, 2, palette, -1, {first, second}));
  CHECK((opaque.width == 3 && opaque.height == 2 && opaque.channels == 3));
  CHECK(opaque.bytes == Bytes{0, 0, 0, 255, 0, 0, 0, 255, 0, 10, 20, 30, 255, 0, 0, 255, 0, 0});
  const Raster clear = raster_of("a.gif", gif_file(3, 2, palette, 2, {first}));
  REQUIRE(clear.channels == 4);
  for (std::size_t i = 0; i < 6; ++i) CHECK(int(clear.bytes[4 * i + 3]) == (i == 2 ? 0 : 255));
}

TEST_CASE("PSD of 8 and 16 bits") {
  const Raster shallow = raster_of("a.psd", psd_file(2, 1, 3, 8, text({1, 2, 11, 12, 21, 22})));
  CHECK(shallow.bytes == Bytes{1, 11, 21, 2, 12, 22});
  const Raster deep = raster_of("a.psd", psd_file(1, 1, 3, 16, text({0x80, 0, 0x40, 0, 0xff, 0xff})));
  CHECK(deep.floats == std::vector<float>{32768.f / 65535.f, 16384.f / 65535.f, 1});
}

TEST_CASE("PGM, text and binary") {
  CHECK(raster_of("a.pgm", "P5 2 1 255\n\x07\xff").bytes == Bytes{7, 255});
  CHECK(raster_of("a.pgm", "P2 2 1 4\n1 4").floats == std::vector<float>{.25f, 1});
}

TEST_CASE("a file is what its first bytes say, whatever its suffix") {
  const Bytes pixels = gradient(8, 8, 3);
  CHECK(raster_of("a.png", written("bmp", 8, 8, 3, pixels)).bytes == pixels);
  CHECK(raster_of("a.jpg", written("png", 8, 8, 3, pixels)).bytes == pixels);
}

TEST_CASE("as textures, bytes stay bytes and encoded values of 16 bits are decoded, but for alpha") {
  const std::string name = "t";
  const auto texture = [&](const std::string& png, ColorSpace space) {
    return make_texture(name, raster_of("a.png", png), space);
  };
  const std::string shallow = png_file(1, 8, 4, {text({51, 102})});
  const std::string deep = png_file(1, 16, 4, {text({0x33, 0x33, 0x66, 0x66})});  // .2 and .4
  CHECK(texture(shallow, ColorSpace::srgb).bytes == Bytes{51, 102});
  const auto decoded = static_cast<float>(ToneCurve{}.decode(.2));
  for (const std::string& png : {shallow, deep}) {
    const Texel light = texel(texture(png, ColorSpace::srgb), 0),
                data = texel(texture(png, ColorSpace::linear), 0);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(light[c] == Approx(decoded));
      CHECK(data[c] == Approx(.2));
    }
    CHECK(light[3] == Approx(.4));
    CHECK(data[3] == Approx(.4));
  }
}

TEST_CASE("images for comparisons: grey is widened, alpha stands apart") {
  const TemporaryFolder folder;
  write_file(folder / "a.png", png_file(1, 8, 4, {text({51, 102})}));
  const ImageFile grey = read_image(folder / "a.png");
  CHECK(grey.encoded);
  CHECK(grey.image.at(0, 0) == Vec3f(51.f / 255));
  CHECK(grey.alpha == std::vector<float>{102.f / 255});
  write_file(folder / "b.png", png_file(1, 8, 2, {text({51, 102, 0})}));
  const ImageFile colour = read_image(folder / "b.png");
  CHECK(colour.image.at(0, 0) == Vec3f(51, 102, 0) / 255.f);
  CHECK(colour.alpha.empty());
}

TEST_CASE("files that are cut or forged give one line with the file's name, before memory is taken") {
  const TemporaryFolder folder;
  const Bytes pixels = gradient(16, 16, 3);
  const std::string palette = text({0, 0, 0, 255, 0, 0, 0, 255, 0, 10, 20, 30});
  const std::pair<std::string, std::string> whole[] = {
      {"a.jpg", written("jpg", 16, 16, 3, pixels)},
      {"a.tga", written("tga", 16, 16, 3, pixels)},
      {"a.bmp", written("bmp", 16, 16, 3, pixels)},
      {"a.gif", gif_file(4, 4, palette, -1, {std::string(16, '\1')})},
      {"a.psd", psd_file(4, 4, 3, 8, std::string(48, '\7'))},
      {"a.png", png_file(1, 8, 0, {text({1}), text({2})})},
      {"a.pgm", "P5 2 2 255\n1234"}};
  for (const auto& [name, bytes] : whole) {
    INFO(name);
    write_file(folder / name, bytes);
    CHECK_NOTHROW(read_raster(folder / name));
    for (const double part : {0.0, 0.05, 0.2, 0.5, 0.9, 0.98}) {
      INFO(part);
      const auto kept = static_cast<std::size_t>(part * static_cast<double>(bytes.size()));
      write_file(folder / name, bytes.substr(0, kept));
      CHECK_THROWS_WITH(read_raster(folder / name),
                        Catch::StartsWith((folder / name).string() + ": ") && !Contains("\n"));
    }
  }
  std::string bomb = written("bmp", 16, 16, 3, pixels);
  bomb.replace(18, 8, little_endian(16000, 4) + little_endian(16000, 4));
  CHECK_THROWS_WITH(raster_of("a.bmp", bomb), Contains("too short for its size"));
  CHECK_THROWS_WITH(
      raster_of("a.gif", "GIF89a" + little_endian(60000) + little_endian(60000) + text({0, 0, 0})),
      Contains("more than 2^28 pixels"));
  CHECK_THROWS_WITH(raster_of("a.psd", psd_file(16000, 16000, 3, 8, "")), Contains("too short for its size"));
  CHECK_THROWS_WITH(raster_of("a.tif", "II*"), Contains("unknown image format '.tif'"));
}

TEST_CASE("a format that is read only is refused as output by name") {
  CHECK_THROWS_WITH(check_output_image("a.jpg"),
                    Contains("'.jpg' are read only; written are .ppm .png .pfm .hdr .exr .film"));
}
