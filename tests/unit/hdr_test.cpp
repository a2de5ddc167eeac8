#include <catch2/catch.hpp>
#include <cmath>

#include "castray/image.h"
#include "core/files.h"
#include "core/sequences.h"
#include "temporary_folder.h"

using namespace castray;
using Catch::Contains;

namespace {

Image image_of(const std::string& header_lines, const std::string& size, const std::string& pixels) {
  const TemporaryFolder folder;
  write_file(folder / "a.hdr",
             "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + header_lines + "\n" + size + "\n" + pixels);
  return read_image(folder / "a.hdr").image;
}

/// A pixel whose red is `value`/256 and whose other values are 0; below 128, it is not as writers make it.
std::string pixel(int value) { return {static_cast<char>(value), 0, 0, static_cast<char>(128)}; }

/// 3x2: 1 2 3 above 4 5 6, in the order in which a file of this size line has them.
std::string six(const std::string& order) {
  std::string pixels;
  for (const char c : order) pixels += pixel(10 * (c - '0'));
  return pixels;
}

}  // namespace

TEST_CASE("HDR: the product of all EXPOSURE and COLORCORR is divided out") {
  const std::string half = {static_cast<char>(128), 64, 32, static_cast<char>(129)};  // 1, .5, .25
  CHECK(image_of("", "-Y 1 +X 1", half).at(0, 0) == Vec3f(1, .5f, .25f));
  const std::filesystem::path golden = CASTRAY_ROOT "/tests/golden/images";
  CHECK(read_image(golden / "exposure.hdr").image.at(7, 7) == Vec3f(.5f, .25f, .125f));
  CHECK(image_of("EXPOSURE=2\n", "-Y 1 +X 1", half).at(0, 0) == Vec3f(.5f, .25f, .125f));
  CHECK(image_of("EXPOSURE= 4.0\nVIEW=x\nEXPOSURE=0.5\n", "-Y 1 +X 1", half).at(0, 0) ==
        Vec3f(.5f, .25f, .125f));
  CHECK(image_of("COLORCORR= 1 2 0.5\nEXPOSURE=2\n", "-Y 1 +X 1", half).at(0, 0) == Vec3f(.5f, .125f, .25f));
  for (const char* line :
       {"EXPOSURE=0\n", "EXPOSURE=x\n", "EXPOSURE=-1\n", "EXPOSURE=nan\n", "COLORCORR=1 1\n"})
    CHECK_THROWS_WITH(image_of(line, "-Y 1 +X 1", half), Contains("a header line that cannot be"));
}

TEST_CASE("HDR: all eight orientations show the same picture") {
  const std::pair<const char*, const char*> orientations[] = {
      {"-Y 2 +X 3", "123456"}, {"-Y 2 -X 3", "321654"}, {"+Y 2 +X 3", "456123"}, {"+Y 2 -X 3", "654321"},
      {"+X 3 -Y 2", "142536"}, {"+X 3 +Y 2", "415263"}, {"-X 3 -Y 2", "362514"}, {"-X 3 +Y 2", "635241"}};
  for (const auto& [size, order] : orientations) {
    INFO(size);
    const Image image = image_of("", size, six(order));
    REQUIRE((image.width == 3 && image.height == 2));
    for (int i = 0; i < 6; ++i) CHECK(image.at(i % 3, i / 3).x == 10 * static_cast<float>(i + 1) / 256);
  }
  for (const char* size : {"-Y 99999999999999999999 +X 3", "-Y 2 -Y 3", "-Y 2 +X 3 ", "Y 2 X 3", "-Y -2 +X 3",
                           "-Y 2", "-Y 0 +X 3", ""})
    CHECK_THROWS_WITH(image_of("", size, six("123456")), Contains("has the size line"));
}

TEST_CASE("HDR: runs of the older kind repeat the pixel before them") {
  const std::string repeat = {1, 1, 1, 3}, more = {1, 1, 1, 1};
  const Image image = image_of("", "-Y 1 +X 5", pixel(50) + repeat + pixel(70));
  for (int x = 0; x < 5; ++x) CHECK(image.at(x, 0).x == (x < 4 ? 50.f : 70.f) / 256);
  const Image longer = image_of("", "-Y 1 +X 260", pixel(50) + repeat + more);  // 3 + 256
  CHECK(longer.at(259, 0).x == 50.f / 256);
  CHECK_THROWS_WITH(image_of("", "-Y 1 +X 5", repeat + pixel(1)), Contains("a run of a wrong length"));
  CHECK_THROWS_WITH(image_of("", "-Y 1 +X 3", pixel(1) + repeat), Contains("a run of a wrong length"));
}

TEST_CASE(
    "HDR: what is written is the nearest that the format holds: neither darker nor brighter on average") {
  const TemporaryFolder folder;
  Image image(200, 100);
  std::uint32_t i = 0;
  for (Vec3f& v : image.pixels)
    for (int c = 0; c < 3; ++c) v[c] = static_cast<float>(hash32(++i)) * 0x1p-32f;  // uniform
  write_image(folder / "a.hdr", image);
  const Image back = read_image(folder / "a.hdr").image;
  double bias = 0;
  float worst = 0;
  for (std::size_t k = 0; k < image.pixels.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      const float greatest = max_component(image.pixels[k]);
      const float unit = std::ldexp(1.f, std::ilogb(greatest) + 1 - 8);
      worst = std::max(worst, std::abs(back.pixels[k][c] - image.pixels[k][c]) / unit);
      bias += double(back.pixels[k][c] - image.pixels[k][c]) / unit;
    }
  CHECK(worst <= 1);  // half a unit, or a whole one where the greatest rounds up to the next power of two
  // Rounding errors are uniform in [-1/2, 1/2]: the mean of 60,000 has the standard deviation .0012.
  CHECK(std::abs(bias / 60000) < 5 * .0012);
  write_image(folder / "b.hdr", back);
  CHECK(read_file(folder / "b.hdr") == read_file(folder / "a.hdr"));
}
