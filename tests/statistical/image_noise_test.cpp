#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "castray/error.h"
#include "castray/noise_test.h"
#include "core/sequences.h"

using namespace castray;

namespace {

/// 20x12 pixels of a ramp times `factor` with independent, nearly normal noise of a known variance.
ImageFile noisy_image(std::uint32_t seed, float factor = 1) {
  constexpr int summands = 12;  // of a uniform number each, of variance 1/12
  ImageFile file{Image(20, 12), false, {}, Noise{Image(20, 12)}};
  std::uint32_t state = hash_combine(seed, 77u);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 20; ++x) {
      const float deviation = 0.01f + 0.002f * static_cast<float>(x);
      for (int c = 0; c < 3; ++c) {
        float sum = -summands / 2;
        for (int i = 0; i < summands; ++i) sum += static_cast<float>(hash32(++state)) * 0x1p-32f;
        file.image.at(x, y)[c] = factor * (0.3f + 0.05f * static_cast<float>(x)) + deviation * sum;
      }
      file.noise->variance.at(x, y) = Vec3f(deviation * deviation);
    }
  return file;
}

}  // namespace

TEST_CASE("Student's t with very many degrees of freedom is normal") {
  const double infinite = std::numeric_limits<double>::infinity();
  CHECK(t_test_p_value(1.959963984540054, infinite) == Approx(0.05).epsilon(1e-12));
  CHECK(t_test_p_value(-5, infinite) == Approx(5.733031437583869e-07).epsilon(1e-10));
  CHECK(t_test_p_value(3, 1e9) == Approx(t_test_p_value(3, 1e7)).epsilon(1e-5));
}

// As for films: at most 50 + 4 sqrt(47.5) = 77 alarms of 1000. Fixed seeds.
TEST_CASE("images with exact variances raise no more than the stated rate of alarms") {
  int alarms = 0;
  for (std::uint32_t trial = 0; trial < 1000; ++trial)
    alarms += test_noise(noisy_image(2 * trial), noisy_image(2 * trial + 1), 0.05).differs();
  INFO(alarms << " alarms of 1000");
  CHECK(alarms <= 77);
  CHECK(alarms >= 25);
}

TEST_CASE("a change of one percent of an image with variances is found") {
  const NoiseTest test = test_noise(noisy_image(1, 1.01f), noisy_image(2), 0.01);
  CHECK(test.differs());
  CHECK(test.t > 0);
  CHECK(test.tests == 3 * (3 * 2 + 2 + 1));
  CHECK_FALSE(test.paired);
  CHECK(test_noise(noisy_image(1), noisy_image(1), 0.01).p == 1);
}

TEST_CASE("fewer degrees of freedom make an image's test more careful") {
  ImageFile few = noisy_image(1, 1.01f), many = few;
  few.noise->freedom = 3;
  many.noise->freedom = 1000;
  const double exact = test_noise(noisy_image(1, 1.01f), noisy_image(2), 0.01).p;
  const double p_many = test_noise(many, noisy_image(2), 0.01).p,
               p_few = test_noise(few, noisy_image(2), 0.01).p;
  CHECK(exact < p_many);
  CHECK(p_many < p_few);
}

TEST_CASE("images that do not tell their noise, or not rightly, cannot be tested") {
  const ImageFile good = noisy_image(1);
  const auto with = [&](const Vec3f& variance) {
    ImageFile bad = good;
    bad.noise->variance.at(3, 2) = variance;
    return bad;
  };
  CHECK_THROWS_WITH(test_noise(with({1, -1, 1}), good, 0.01),
                    Catch::Contains("pixel (3,2) of the image has a variance"));
  CHECK_THROWS_WITH(test_noise(good, with(Vec3f(std::numeric_limits<float>::quiet_NaN())), 0.01),
                    Catch::Contains("pixel (3,2) of the reference has"));
  ImageFile small = good, none = good, no_freedom = good;
  small.noise->variance = Image(3, 3);
  none.noise.reset();
  no_freedom.noise->freedom = 0;
  CHECK_THROWS_WITH(test_noise(small, good, 0.01), Catch::Contains("another size"));
  CHECK_THROWS_WITH(test_noise(none, good, 0.01), Catch::Contains("image does not tell its noise"));
  CHECK_THROWS_WITH(test_noise(no_freedom, good, 0.01), Catch::Contains("degree of freedom"));
}
