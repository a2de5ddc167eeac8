#include <catch2/catch.hpp>

#include "castray/film.h"
#include "core/sequences.h"

using namespace castray;

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

TEST_CASE("films that share a sample are refused") {
  Film a = film_of(0, 10);
  CHECK_THROWS_WITH(a.merge(film_of(9, 3)), Catch::Contains("sample 9"));
}
