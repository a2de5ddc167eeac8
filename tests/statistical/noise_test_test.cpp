#include "castray/noise_test.h"

#include <catch2/catch.hpp>

#include "castray/error.h"
#include "core/files.h"
#include "core/sequences.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// A film of 24x16 pixels, 8 replicates of `spp` samples: uniform noise around a ramp, all of it times
/// `factor`.
Film noisy_film(std::uint32_t seed, int spp, float factor = 1) {
  Film whole;
  for (std::uint32_t r = 0; r < 8; ++r) {
    Film film({24, 16, 0, 0, 24, 16}, 8);
    std::uint32_t state = hash_combine(seed, r);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 24; ++x)
        for (int i = 0; i < spp; ++i) {
          const auto u = [&] { return static_cast<float>(hash32(++state)) * 0x1p-32f; };
          const float ramp = 0.2f + static_cast<float>(x) * 0.1f;
          const Vec3f noise{u(), u(), u()};
          film.add(x, y, noise * (2 * ramp * factor));
        }
    film.samples = {{r * replicate_length, static_cast<std::uint64_t>(spp)}};
    film.key = "seed=" + std::to_string(seed);
    film.keep_replicates();
    if (r == 0)
      whole = film;
    else
      whole.merge(film);
  }
  return whole;
}

}  // namespace

TEST_CASE("Student's t has the tails that SciPy computes") {
  CHECK(t_test_p_value(1, 1) == Approx(0.5));
  CHECK(t_test_p_value(5.9, 14) == Approx(3.8680419497611794e-05).epsilon(1e-10));
  CHECK(t_test_p_value(-2.5, 7.3) == Approx(0.03965023466560043).epsilon(1e-10));
  CHECK(t_test_p_value(40, 2) == Approx(0.0006244146721847406).epsilon(1e-10));
  CHECK(t_test_p_value(0.1, 60) == Approx(0.9206777120565489).epsilon(1e-10));
  CHECK(t_test_p_value(12, 30) == Approx(5.580185415199261e-13).epsilon(1e-9));
}

// The family-wise rate is at most alpha (Bonferroni): of 1000 pairs at alpha = 0.05 at most 50 + 4 sqrt(47.5)
// = 77 alarms are expected, and not none, which would show a test without power. Fixed seeds.
TEST_CASE("films that differ only in seed raise no more than the stated rate of alarms") {
  int alarms = 0;
  double squares = 0;
  for (std::uint32_t trial = 0; trial < 1000; ++trial) {
    const NoiseTest test = test_noise(noisy_film(2 * trial, 1), noisy_film(2 * trial + 1, 1), 0.05);
    alarms += test.differs();
    squares += test.rms_t * test.rms_t / 1000;
  }
  INFO(alarms << " alarms of 1000");
  CHECK(alarms <= 77);
  CHECK(alarms >= 5);
  constexpr double freedom = 2 * 7;                                 // of 8 replicates on each side
  CHECK(squares == Approx(freedom / (freedom - 2)).epsilon(0.05));  // the variance of Student's t
}

TEST_CASE("a change of one percent is found, with its place") {
  const NoiseTest test = test_noise(noisy_film(1, 64, 1.01f), noisy_film(2, 64), 0.01);
  CHECK(test.differs());
  CHECK(test.t > 0);
  CHECK(test.mean == Approx(test.mean_reference * 1.01).epsilon(0.002));
  const NoiseTest itself = test_noise(noisy_film(3, 64), noisy_film(3, 64), 0.01);
  CHECK_FALSE(itself.differs());
  CHECK(itself.p == 1);
  CHECK(itself.rms_t == 0);
  CHECK(itself.paired);
  const NoiseTest same_seed = test_noise(noisy_film(3, 4, 1.001f), noisy_film(3, 4), 0.01);
  CHECK(same_seed.differs());  // the noise is common to both and falls out
  CHECK_FALSE(test_noise(noisy_film(4, 4, 1.001f), noisy_film(3, 4), 0.01).differs());
  CHECK(itself.tests == 3 * (6 + 2 + 1));
}

TEST_CASE("films without replicates, or of another window, cannot be tested") {
  const Film film = noisy_film(1, 1);
  Film plain({24, 16, 0, 0, 24, 16}, 8), other({24, 16, 0, 0, 16, 16}, 8);
  CHECK_THROWS_WITH(test_noise(film, plain, 0.01), Catch::Contains("reference does not tell its noise"));
  plain.samples = {{99 * replicate_length, 1}};
  plain.key = "seed=1";
  CHECK_THROWS_WITH(plain.merge(film), Catch::Contains("different renders: no replicates against some"));
  other.keep_replicates();
  Film next = other;
  other.samples = {{0, 1}}, next.samples = {{replicate_length, 1}};
  next.keep_replicates();
  other.merge(next);
  CHECK_THROWS_WITH(test_noise(other, film, 0.01), Catch::Contains("different windows"));
}

TEST_CASE("films with replicates are stored and merged to the same bytes in any order") {
  const TemporaryFolder folder;
  std::vector<Film> parts;
  for (std::uint32_t part = 0; part < 4; ++part) {
    Film film({20, 12, 3, 2, 20, 12}, 2);
    for (int y = 2; y < 12; ++y)
      for (int x = 3; x < 20; ++x)
        film.add(x, y,
                 Vec3f(static_cast<float>(hash32(part + 7u * static_cast<std::uint32_t>(x * y))) * 0x1p-32f));
    film.samples = {{(part / 2) * replicate_length + part % 2, 1}};  // two parts of each of two replicates
    film.keep_replicates();
    parts.push_back(film);
  }
  std::string bytes;
  for (const std::vector<std::size_t>& order :
       {std::vector<std::size_t>{0, 1, 2, 3}, {3, 1, 0, 2}, {2, 0, 3, 1}}) {
    Film whole = parts[order[0]];
    for (std::size_t i = 1; i < 4; ++i) whole.merge(parts[order[i]]);
    write_film(folder / "whole.film", whole);
    if (bytes.empty()) bytes = read_file(folder / "whole.film");
    CHECK(read_file(folder / "whole.film") == bytes);
  }
  const Film whole = read_film(folder / "whole.film");
  const auto means = whole.replicate_means(whole.blocks());
  REQUIRE(means.size() == 2);
  Vec3d sum;
  for (const Vec3f& v : whole.image().pixels) sum += Vec3d(v);
  CHECK((means[0].x + means[1].x) / 2 == Approx(sum.x / (17 * 10)));
}
