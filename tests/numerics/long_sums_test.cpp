#include <catch2/catch.hpp>

#include <cmath>

#include "castray/film.h"
#include "core/sequences.h"

using namespace castray;

// A million samples in one pixel, against their exact sum.

namespace {

constexpr std::uint32_t samples = 1'000'000;

/// Like radiance: mostly small, sometimes the light itself; a multiple of 2^-30 below 2^6, so exact in
/// integers.
float radiance(std::uint32_t i) {
  const float u = static_cast<float>(hash32(i) >> 8) * 0x1p-24f;
  return i % 100 == 0 ? 47.83f : std::round(u * u * 0x1p30f) * 0x1p-30f;
}

}  // namespace

TEST_CASE("a film's mean of a million samples is exact, where a float's is not") {
  Film film({1, 1, 0, 0, 1, 1}, 47.83);
  std::int64_t exact = 0;
  float naive = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const float v = radiance(i);
    film.add(0, 0, Vec3f(v));
    exact += static_cast<std::int64_t>(static_cast<double>(v) * 0x1p30);
    naive += v / samples;
  }
  const double mean = static_cast<double>(exact) * 0x1p-30 / samples;
  CHECK(std::abs(film.mean(0, 0).x / mean - 1) < 1e-15);
  CHECK(std::abs(static_cast<double>(film.image().at(0, 0).x) / mean - 1) < 1e-7);  // rounded to float once
  CHECK(std::abs(static_cast<double>(naive) / mean - 1) > 1e-5);
}
