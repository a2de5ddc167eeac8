#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <vector>

#include "castray/error.h"
#include "castray/film.h"
#include "core/files.h"
#include "core/sequences.h"
#include "film_bytes.h"
#include "small_tiles.h"
#include "temporary_folder.h"

using namespace castray;
using namespace castray::test;

namespace {

constexpr Window window{40, 30, 9, 5, 31, 22};

TiledFilm film_of(std::uint32_t first, std::uint32_t count, const Window& shown = window) {
  TiledFilm film(shown);
  for (std::uint32_t s = first; s < first + count; ++s)
    film.add_sample(s, [s](int x, int y) {
      const float u =
          static_cast<float>(hash32(hash_combine(hash_combine(s, std::uint32_t(x)), std::uint32_t(y)))) *
          0x1p-32f;
      return Vec3f(u * 4, u * u, 0.1f);
    });
  film.samples = {{first, count}};
  return film;
}

}  // namespace

TEST_CASE("sums of differences do not depend on how samples are split and merged") {
  const Film whole = film_of(0, 20);
  Film parts = film_of(13, 7);
  parts.merge(film_of(0, 6));
  parts.merge(film_of(6, 7));
  CHECK(bytes(parts) == bytes(whole));
  CHECK(image_of(parts).pixels == image_of(whole).pixels);
}

TEST_CASE("a film with differences comes back from its file, and its image is that of the file") {
  const TemporaryFolder folder;
  const Film film = film_of(0, 16);
  write_film(folder / "a.film", film);
  write_film(folder / "a.pfm", film);
  const Film read = read_film(folder / "a.film");
  REQUIRE(read.differences().kept());
  CHECK(bytes(read) == read_file(folder / "a.film"));
  CHECK(read_image(folder / "a.film").image.pixels == image_of(film).pixels);
  CHECK(read_image(folder / "a.pfm").image.pixels == image_of(film).pixels);
  CHECK(image_of(film).pixels != film.image().pixels);
}

TEST_CASE("crops put together have the sums of the whole image") {
  const Window all{40, 30, 0, 0, 40, 30};
  Film whole = film_of(0, 9, all), parts = whole.without_samples(all);
  for (const Window& crop :
       {Window{40, 30, 0, 0, 13, 30}, Window{40, 30, 13, 0, 40, 11}, Window{40, 30, 13, 11, 40, 30}})
    parts.add(film_of(0, 9, crop));
  parts.samples = whole.samples;
  CHECK(bytes(parts) == bytes(whole));
}

TEST_CASE("films with and without differences are not merged") {
  Film with = film_of(0, 2), without(window, 8);
  without.samples = {{2, 2}};
  without.key = with.key;
  CHECK_THROWS_WITH(with.merge(without), Catch::Contains("differences"));
  CHECK_THROWS_WITH(without.merge(with), Catch::Contains("differences"));
}

TEST_CASE("a pixel's sums are those of the samples whose tile has its neighbour") {
  TiledFilm film(window);
  double all = 0;
  std::array<double, 4> apart{};  // by Side
  std::uint32_t with_right = 0;
  constexpr int x = 15, y = 12, samples = 40;
  for (std::uint32_t s = 0; s < 2 * samples; s += 2) {  // of the even half
    const auto value = [s](int i, int j) {
      return Vec3f(static_cast<float>(i + 2 * j + static_cast<int>(s)) / 64);
    };
    film.add_sample(s, value);
    const Tiles tiles(window, s);
    const int left = (x + tiles.shift_x) % 8, top = (y + tiles.shift_y) % 8;
    all += value(x, y).x;
    if (left == 0) apart[DifferenceSums::left] += value(x, y).x;
    if (left == 7) apart[DifferenceSums::right] += value(x, y).x;
    if (top == 0) apart[DifferenceSums::above] += value(x, y).x;
    if (top == 7) apart[DifferenceSums::below] += value(x, y).x;
    with_right += left < 7 ? 1 : 0;
  }
  const std::size_t at = static_cast<std::size_t>((y - window.y0) * window.width() + x - window.x0);
  const DifferenceSums& sums = film.differences();
  const DifferenceSums::Pixel& p = sums.at(at, 0);
  CHECK(p.count == samples);
  CHECK(p.with_right == with_right);
  CHECK(static_cast<double>(p.all[0]) * sums.radiance_unit() == all);
  for (const auto side :
       {DifferenceSums::left, DifferenceSums::right, DifferenceSums::above, DifferenceSums::below})
    CHECK(static_cast<double>(sums.apart_at(at, 0).sum[side][1]) * sums.radiance_unit() == apart[side]);
  CHECK(sums.at(at, 1).count == 0);
}

TEST_CASE("faint radiance is rounded to units without a bias") {
  TiledFilm film({8, 8, 0, 0, 8, 8});
  constexpr int samples = 4000;
  const float faint = static_cast<float>(0.3 * film.differences().radiance_unit());
  for (std::uint32_t s = 0; s < samples; ++s) film.add_sample(s, [faint](int, int) { return Vec3f(faint); });
  double sum = 0;
  for (std::size_t i = 0; i < 64; ++i)
    for (int half = 0; half < 2; ++half) sum += static_cast<double>(film.differences().at(i, half).all[2]);
  const double error = std::sqrt(0.3 * 0.7 * 64 * samples);
  CHECK(std::abs(sum - 0.3 * 64 * samples) < 5 * error);  // a false alarm in 1.7 million
}
