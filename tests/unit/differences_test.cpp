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
  for (std::uint32_t s = first; s < first + count; ++s) {
    const Tiles tiles(shown, s);
    film.add_sample(s, [&](int x, int y) {
      const auto uniform = [s](int i, int j) {
        return static_cast<float>(hash32(hash_combine(hash_combine(s, std::uint32_t(i)), std::uint32_t(j)))) *
               0x1p-32f;
      };
      const float own = uniform(x, y), of_tile = uniform((x + tiles.shift_x) / 8, (y + tiles.shift_y) / 8);
      return Vec3f(own * 0.1f + of_tile * 4, own * own, 0.1f);
    });
  }
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

TEST_CASE("differences are summed over the samples whose tile has both pixels, by halves") {
  TiledFilm film(window);
  double own = 0, right = 0, below = 0;
  std::uint32_t with_right = 0, with_below = 0;
  constexpr int x = 15, y = 12, samples = 40;
  for (std::uint32_t s = 0; s < 2 * samples; s += 2) {  // of the even half
    const auto value = [s](int i, int j) {
      return Vec3f(static_cast<float>((i + 2 * j * j + static_cast<int>(s) * i) % 64) / 64);
    };
    film.add_sample(s, value);
    const Tiles tiles(window, s);
    own += value(x, y).x;
    if ((x + tiles.shift_x) % 8 < 7) ++with_right, right += value(x + 1, y).x - value(x, y).x;
    if ((y + tiles.shift_y) % 8 < 7) ++with_below, below += value(x, y + 1).x - value(x, y).x;
  }
  const DifferenceSums& sums = film.differences();
  using Term = DifferenceSums::Term;
  const auto count = [&](int half, Term term) {
    return sums.counts(half, y - window.y0, term)[x - window.x0];
  };
  const auto sum = [&](Term term) {
    return static_cast<double>(sums.sums(0, y - window.y0, term, 1)[x - window.x0]) * sums.radiance_unit();
  };
  constexpr std::uint32_t takes = DifferenceSums::most_takes;  // that each sample counts as
  CHECK(count(0, Term::own) == takes * samples);
  CHECK(count(0, Term::right) == takes * with_right);
  CHECK(count(0, Term::below) == takes * with_below);
  CHECK(sum(Term::own) == takes * own);
  CHECK(sum(Term::right) == takes * right);
  CHECK(sum(Term::below) == takes * below);
  CHECK(count(1, Term::own) == 0);
}

TEST_CASE("a sample of two takes is their mean, and counts with the last one") {
  const auto film_of_takes = [](std::uint64_t kept_of_first) {
    Film film({8, 8, 0, 0, 8, 8}, 1);
    film.keep_differences();
    for (int take = 0; take < 2; ++take) {
      std::array<float, 64> radiance, emitted = {};
      radiance.fill(take == 0 ? 0.25f : 0.75f);
      const std::uint64_t kept = take == 0 ? kept_of_first : ~std::uint64_t{0};
      TileSamples tile{.take = take, .takes = 2, .kept = kept, .smooth = kept};
      for (int c = 0; c < 3; ++c) tile.radiance[c] = radiance.data(), tile.emitted[c] = emitted.data();
      film.add({&tile, 1}, 0, 8);
      CHECK(film.count(3, 4) == static_cast<std::uint32_t>(take));
    }
    return film;
  };
  const Film film = film_of_takes(~std::uint64_t{0});
  CHECK(film.mean(3, 4) == Vec3d(0.5, 0.5, 0.5));
  const DifferenceSums& sums = film.differences();
  CHECK(sums.counts(0, 4, DifferenceSums::own)[3] == 2);
  CHECK(static_cast<double>(sums.sums(0, 4, DifferenceSums::own, 0)[3]) * sums.radiance_unit() == 1);
  // a take that is not finite is black
  CHECK(film_of_takes(~(std::uint64_t{1} << (4 * 8 + 3))).mean(3, 4) == Vec3d(0.375, 0.375, 0.375));
}

TEST_CASE("pixels that see an edge have samples, but no part in differences") {
  Film film({8, 8, 0, 0, 8, 8}, 1);
  film.keep_differences();
  std::array<float, 64> radiance, emitted = {};
  for (std::size_t i = 0; i < 64; ++i) radiance[i] = static_cast<float>(i);
  TileSamples tile{.kept = ~std::uint64_t{0}, .smooth = ~(std::uint64_t{1} << (8 * 3 + 5))};
  for (int c = 0; c < 3; ++c) {
    tile.radiance[c] = radiance.data();
    tile.emitted[c] = emitted.data();
  }
  film.add({&tile, 1}, 0, 8);
  const DifferenceSums& sums = film.differences();
  using Term = DifferenceSums::Term;
  CHECK(film.count(5, 3) == 1);
  CHECK(film.mean(5, 3).x == 29);
  for (const Term term : {Term::own, Term::right, Term::below}) CHECK(sums.counts(0, 3, term)[5] == 0);
  CHECK(sums.counts(0, 3, Term::own)[4] == DifferenceSums::most_takes);
  CHECK(sums.counts(0, 3, Term::right)[4] == 0);
  CHECK(sums.counts(0, 3, Term::right)[3] == DifferenceSums::most_takes);
  CHECK(sums.counts(0, 2, Term::below)[5] == 0);
  CHECK(sums.sums(0, 2, Term::below, 0)[5] == 0);
  CHECK(static_cast<double>(sums.sums(0, 2, Term::below, 0)[4]) * sums.radiance_unit() ==
        8 * DifferenceSums::most_takes);
}

TEST_CASE("neighbours in a ragged tile have differences, wherever in it they are") {
  // pixel i at 5 i modulo 64 of the square, but that four of its pixels have changed places with some outside
  std::array<float, 64> radiance, emitted = {};
  std::array<std::uint32_t, 64> at_x, at_y;
  std::array<int, 16 * 16> pixel_at;
  pixel_at.fill(-1);
  for (int i = 0; i < 64; ++i) {
    int x = 8 + i * 5 % 64 % 8, y = 8 + i * 5 % 64 / 8;
    if (x == 8 && y < 10) x = 7;
    if (y == 15 && x > 13) y = 16;
    const auto k = static_cast<std::size_t>(i);
    at_x[k] = static_cast<std::uint32_t>(x);
    at_y[k] = static_cast<std::uint32_t>(y);
    radiance[k] = static_cast<float>(i * i % 37);
    pixel_at[static_cast<std::size_t>((y - 4) * 16 + x - 4)] = i;
  }
  constexpr int edge = 30, not_kept = 17;
  TileSamples tile{.x = 8,
                   .y = 8,
                   .kept = ~(std::uint64_t{1} << not_kept),
                   .smooth = ~(std::uint64_t{1} << edge),
                   .ragged_x = at_x.data(),
                   .ragged_y = at_y.data()};
  for (int c = 0; c < 3; ++c) {
    tile.radiance[c] = radiance.data();
    tile.emitted[c] = emitted.data();
  }
  Film film({24, 24, 0, 0, 24, 24}, 64);
  film.keep_differences();
  film.add({&tile, 1}, 0, 10);  // in two parts, as where rows are locked one after the other
  film.add({&tile, 1}, 10, 24);
  const DifferenceSums& sums = film.differences();
  using Term = DifferenceSums::Term;
  constexpr std::uint32_t takes = DifferenceSums::most_takes;  // that each sample counts as
  int differences = 0;
  for (int y = 4; y < 19; ++y)
    for (int x = 4; x < 19; ++x) {
      const auto at = [&](int dx, int dy) {
        return pixel_at[static_cast<std::size_t>((y + dy - 4) * 16 + x + dx - 4)];
      };
      const auto value = [&](int i) { return double{radiance[static_cast<std::size_t>(i)]}; };
      const auto sum = [&](Term term) {
        return static_cast<double>(sums.sums(0, y, term, 1)[x]) * sums.radiance_unit();
      };
      const int here = at(0, 0);
      const bool counts = here >= 0 && here != not_kept, smooth = counts && here != edge;
      CHECK(film.count(x, y) == (counts ? 1 : 0));
      CHECK(film.mean(x, y).y == (counts ? value(here) : 0));
      CHECK(sums.counts(0, y, Term::own)[x] == (smooth ? takes : 0));
      CHECK(sum(Term::own) == (smooth ? takes * value(here) : 0));
      for (const auto& [term, there] : {std::pair(Term::right, at(1, 0)), {Term::below, at(0, 1)}}) {
        const bool pair = smooth && there >= 0 && there != edge;
        CHECK(sums.counts(0, y, term)[x] == (pair ? takes : 0));
        CHECK(sum(term) == (pair ? takes * (value(there) - value(here)) : 0));
        differences += pair ? 1 : 0;
      }
    }
  CHECK(differences > 90);
}

TEST_CASE("radiance is summed to the nearest unit") {
  TiledFilm film({8, 8, 0, 0, 8, 8});
  const double unit = film.differences().radiance_unit();
  for (const double value : {0.4, 0.6, 7.3, 1048576.75}) {
    const auto before = film.differences().sums(0, 0, DifferenceSums::own, 2)[0];
    film.add_sample(0, [&](int, int) { return Vec3f(static_cast<float>(value * unit)); });
    CHECK(film.differences().sums(0, 0, DifferenceSums::own, 2)[0] - before ==
          std::llround(DifferenceSums::most_takes * double{static_cast<float>(value * unit)} / unit));
  }
}
