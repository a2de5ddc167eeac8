#include <catch2/catch.hpp>

#include "castray/error.h"
#include "castray/film.h"
#include "core/files.h"
#include "core/sequences.h"
#include "film_bytes.h"
#include "temporary_folder.h"
#include "test_image.h"

using namespace castray;
using castray::test::bytes;

namespace {

constexpr Window one_pixel{1, 1, 0, 0, 1, 1};

Vec3f awkward_sample(std::uint32_t i) {
  const float u = static_cast<float>(hash32(i)) * 0x1p-32f;
  return {u * 50.f, u * u * 1e-4f, std::exp2(-40.f * u)};
}

Film film_of(std::uint32_t first, std::uint32_t count) {
  Film film(one_pixel, 50);
  for (std::uint32_t i = first; i < first + count; ++i) film.add(0, 0, awkward_sample(i));
  film.samples = {{first, count}};
  return film;
}

}  // namespace

TEST_CASE("film sums do not depend on how samples are split and merged") {
  const Film whole = film_of(0, 3000);
  Film parts = film_of(1700, 1300);
  parts.merge(film_of(0, 900));
  parts.merge(film_of(900, 800));
  CHECK(parts.mean(0, 0) == whole.mean(0, 0));
  CHECK(parts.samples == whole.samples);
  CHECK(parts.count(0, 0) == 3000);
}

TEST_CASE("splats add to the mean by the number of light paths, in any order, and are in a film's file") {
  const auto splatted = [](std::uint32_t first, std::uint32_t count) {
    Film film = film_of(first, count);
    film.keep_splats();
    for (std::uint32_t i = first; i < first + count; i += 3) film.add_splat(0, 0, awkward_sample(i + 7));
    film.add_light_paths(5 * count);
    return film;
  };
  const Film whole = splatted(0, 3000);
  Film parts = splatted(1800, 1200);
  parts.merge(splatted(0, 900));
  parts.merge(splatted(900, 900));
  CHECK(bytes(parts) == bytes(whole));
  CHECK(parts.light_paths(0, 0) == 15000);
  Vec3d sum;
  for (std::uint32_t i = 0; i < 3000; i += 3) sum += Vec3d(awkward_sample(i + 7));
  CHECK(whole.mean_of_splats(0, 0).x == Approx(sum.x / 15000));
  CHECK(whole.mean(0, 0) == film_of(0, 3000).mean(0, 0) + whole.mean_of_splats(0, 0));

  const TemporaryFolder folder;
  write_film(folder / "x.film", whole);
  CHECK(bytes(read_film(folder / "x.film")) == bytes(whole));
  CHECK(read_film(folder / "x.film").mean(0, 0) == whole.mean(0, 0));
}

TEST_CASE("the means of replicates have their splats") {
  const auto replicate = [](std::uint64_t index, float value, float splat) {
    Film film(Window{10, 9, 0, 0, 10, 9}, 1);
    film.keep_splats();
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 10; ++x) {
        film.add(x, y, {value, value, value});
        film.add_splat(x, y, {splat, splat, splat});
      }
    film.add_light_paths(90);
    film.samples = {{index * replicate_length, 1}};
    film.keep_replicates();
    return film;
  };
  Film film = replicate(0, 1, 0.5f);
  film.merge(replicate(1, 2, 0.25f));
  const std::vector<Vec3d> means = film.replicate_means(film.blocks());
  REQUIRE(means.size() == 2);
  CHECK(means[0].x == Approx(1.5));
  CHECK(means[1].x == Approx(2.25));
}

TEST_CASE("films that share a sample are refused") {
  Film a = film_of(0, 10);
  CHECK_THROWS_WITH(a.merge(film_of(9, 3)), Catch::Contains("sample 9"));
}

TEST_CASE("a film file is the same bytes however its samples were split and merged") {
  const TemporaryFolder folder;
  write_film(folder / "whole.film", test_film(5, 4, 0, 30));
  write_film(folder / "a.film", test_film(5, 4, 0, 7));
  write_film(folder / "b.film", test_film(5, 4, 7, 11));
  write_film(folder / "c.film", test_film(5, 4, 18, 12));
  for (const std::string order : {"abc", "bca", "cab", "cba"}) {
    Film merged = read_film(folder / (order.substr(0, 1) + ".film"));
    for (const char name : order.substr(1))
      merged.merge(read_film(folder / (std::string(1, name) + ".film")));
    write_film(folder / "merged.film", merged);
    CHECK(read_file(folder / "merged.film") == read_file(folder / "whole.film"));
  }
  CHECK(read_image(folder / "whole.film").image.pixels == test_film(5, 4, 0, 30).image().pixels);
}

TEST_CASE("films of different renders are refused with what differs, and stay as they were") {
  Film film = test_film(2, 2, 0, 3);
  Film other = test_film(2, 2, 3, 3);
  other.key = "scene=test; seed=1";
  CHECK_THROWS_WITH(film.merge(other), Catch::Contains("seed=0 against seed=1") && !Catch::Contains("scene"));
  CHECK_THROWS_WITH(film.merge(test_film(2, 3, 3, 3)), Catch::Contains("0,0,2,2 of 2x2 and 0,0,2,3 of 2x3"));
  CHECK_THROWS_WITH(film.merge(test_film(2, 2, 2, 3)), Catch::Contains("sample 2"));
  CHECK(film.samples == std::vector<SampleRange>{{0, 3}});
  CHECK(film.count(0, 0) == 3);
}

TEST_CASE("a film file that is cut or changed is refused") {
  const TemporaryFolder folder;
  write_film(folder / "a.film", test_film(3, 3, 0, 2));
  const std::string whole = read_file(folder / "a.film");
  for (std::size_t length = 0; length < whole.size(); length += 13) {
    write_file(folder / "cut.film", whole.substr(0, length));
    CHECK_THROWS_AS(read_film(folder / "cut.film"), InputError);
  }
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 4);
    write_file(folder / "changed.film", changed);
    CHECK_THROWS_AS(read_film(folder / "changed.film"), InputError);
  }
  write_file(folder / "long.film", whole + "x");
  CHECK_THROWS_WITH(read_film(folder / "long.film"), Catch::Contains("behind its end"));
}
