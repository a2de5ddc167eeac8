#include "image/reconstruction.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "castray/film.h"
#include "castray/render.h"
#include "core/sequences.h"
#include "image/screened_poisson.h"
#include "small_tiles.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

constexpr Window window{48, 40, 0, 0, 48, 40};

float uniform(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return (static_cast<float>(hash_combine(hash_combine(a, b), c) >> 8) + 0.5f) * 0x1p-24f;
}

/// A wall with a slope, an edge, and fine stripes.
Vec3f truth(int x, int y) {
  const float slope = 0.3f + 0.01f * static_cast<float>(x), stripe = y > 30 && x % 2 == 0 ? 0.4f : 1.f;
  return x < 20 ? Vec3f(slope, slope / 2, 0.05f) * stripe : Vec3f(0.1f, 0.2f, 0.6f) * stripe;
}

/// Samples of the truth whose errors are alike in a tile, as those of shared paths are: an exponential factor
/// of the tile and a little noise of the pixel's own, both with mean 1.
TiledFilm noisy_film(std::uint32_t seed, std::uint32_t samples) {
  TiledFilm film(window);
  for (std::uint32_t s = 0; s < samples; ++s) {
    const std::uint32_t key = hash_combine(seed, s);
    const Tiles tiles(window, s);
    film.add_sample(s, [&](int x, int y) {
      const auto column = static_cast<std::uint32_t>((x + tiles.shift_x) / 8),
                 row = static_cast<std::uint32_t>((y + tiles.shift_y) / 8);
      const float factor = -std::log(uniform(key, column, row));
      return truth(x, y) * factor * (0.9f + 0.2f * uniform(key + 1, std::uint32_t(x), std::uint32_t(y)));
    });
  }
  film.samples = {{0, samples}};
  return film;
}

Vec3d mean_of(const Image& image) {
  Vec3d sum;
  for (const Vec3f& p : image.pixels) sum += Vec3d(p);
  return sum / static_cast<double>(image.pixels.size());
}

double squared_error(const Image& image) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec3f d = image.at(x, y) - truth(x, y);
      sum += dot(d, d);
    }
  return sum;
}

float mean_of(const PixelPlane& plane, int width, int height) {
  double sum = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) sum += plane.row(y)[x];
  return static_cast<float>(sum / (width * height));
}

}  // namespace

TEST_CASE("multigrid comes near the solution of the equations, with strong and weak couplings side by side") {
  constexpr int w = 37, h = 29;
  ScreenedPoisson solver(w, h, 3);
  PixelEquations equations(w, h);
  PixelCouplings& a = equations.a;
  PixelPlanes &b = equations.b, exact = b;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      a.screen.row(y)[x] = 1;
      if (x + 1 < w) a.right.row(y)[x] = x == 17 ? 0.01f : 300.f;
      if (y + 1 < h) a.below.row(y)[x] = y == 9 ? 0.01f : 300.f;
      for (std::uint32_t c = 0; c < 3; ++c)
        exact[c].row(y)[x] = uniform(c, std::uint32_t(x / 6), std::uint32_t(y / 6)) - 0.5f;
    }
  for (std::size_t c = 0; c < 3; ++c)
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const float* e = exact[c].row(y);
        b[c].row(y)[x] = a.screen.row(y)[x] * e[x] + a.right.row(y)[x] * (e[x] - e[x + 1]) +
                         a.right.row(y)[x - 1] * (e[x] - e[x - 1]) +
                         a.below.row(y)[x] * (e[x] - exact[c].row(y + 1)[x]) +
                         a.below.row(y - 1)[x] * (e[x] - exact[c].row(y - 1)[x]);
      }
  const PixelPlanes one = solver.solve(equations), again = solver.solve(equations);
  double error = 0, size = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(one[c].values == again[c].values);
    for (std::size_t i = 0; i < exact[c].values.size(); ++i) {
      error += std::pow(one[c].values[i] - exact[c].values[i], 2);
      size += std::pow(exact[c].values[i], 2);
    }
  }
  CHECK(error < 0.15 * size);
}

TEST_CASE("multigrid makes the same of a large image with any number of threads") {
  constexpr int w = 301, h = 227;
  const auto solved = [&](int threads) {
    PixelEquations equations(w, h);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const auto random = [&](std::uint32_t i) { return uniform(i, std::uint32_t(x), std::uint32_t(y)); };
        equations.a.screen.row(y)[x] = random(0);
        if (x + 1 < w) equations.a.right.row(y)[x] = 100 * random(1);
        if (y + 1 < h) equations.a.below.row(y)[x] = 100 * random(2);
        for (std::uint32_t c = 0; c < 3; ++c) equations.b[c].row(y)[x] = random(3 + c);
      }
    return ScreenedPoisson(w, h, threads).solve(std::move(equations));
  };
  const PixelPlanes one = solved(1), three = solved(3);
  for (std::size_t c = 0; c < 3; ++c) CHECK(one[c].values == three[c].values);
}

TEST_CASE("an image is the same for any number of threads") {
  const TiledFilm film = noisy_film(1, 16);
  CHECK(image_of(film, 1).pixels == image_of(film, 5).pixels);
}

TEST_CASE("errors that are alike in a tile are taken out") {
  Mean before, after;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const TiledFilm film = noisy_film(seed, 32);
    before.add(squared_error(film.image()));
    after.add(squared_error(image_of(film)));
  }
  CHECK(after.mean() < before.mean() / 3);
}

TEST_CASE("rare bright samples of single pixels are not spread") {
  Mean before, after;
  for (std::uint32_t seed = 0; seed < 16; ++seed) {
    TiledFilm film(window);
    for (std::uint32_t s = 0; s < 32; ++s)
      film.add_sample(s, [&](int x, int y) {
        const bool rare = uniform(hash_combine(seed, s), std::uint32_t(x), std::uint32_t(y)) < 1e-3f;
        return truth(x, y) * (rare ? 500.5f : 0.5f);
      });
    before.add(squared_error(film.image()));
    after.add(squared_error(image_of(film)));
  }
  CHECK(after.mean() < 1.02 * before.mean());
}

TEST_CASE("the image of a part of a film is as good as the whole, though differences lead out of it") {
  Mean before, after;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const Film part = noisy_film(seed, 32).part({48, 40, 3, 5, 40, 28});
    const auto error = [&](const Image& image) {
      double sum = 0;
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
          const Vec3f d = image.at(x, y) - truth(x + 3, y + 5);
          sum += dot(d, d);
        }
      return sum;
    };
    before.add(error(part.image()));
    after.add(error(image_of(part)));
  }
  CHECK(after.mean() < before.mean() / 3);
}

TEST_CASE("few samples, corrected as one, have much less noise and no bias") {
  for (const std::uint32_t samples : {2u, 3u, 5u}) {
    Mean before, after, bias;
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
      const TiledFilm film = noisy_film(700 + seed, samples);
      REQUIRE(has_few_samples(film.differences()));
      const Image image = image_of(film), mean = film.image();
      before.add(squared_error(mean));
      after.add(squared_error(image));
      bias.add((mean_of(image) - mean_of(mean)).y);
    }
    CAPTURE(samples, before.mean(), after.mean(), bias.mean(), bias.error());
    CHECK(after.mean() < before.mean() * 0.6);
    CHECK(std::abs(bias.mean()) < 4.5 * bias.error());  // a false alarm in 150,000
  }
  CHECK(!has_few_samples(noisy_film(2, 6).differences()));
}

TEST_CASE("with one sample, or where all is black, the image is the mean") {
  const TiledFilm film = noisy_film(2, 1);
  CHECK(image_of(film).pixels == film.image().pixels);
  TiledFilm black(window);
  for (std::uint32_t s = 0; s < 8; ++s) black.add_sample(s, [](int, int) { return Vec3f(); });
  for (const Vec3f& p : image_of(black).pixels) REQUIRE(p == Vec3f());
}

TEST_CASE("reconstructed images are the same in any unit of radiance") {
  RenderOptions options;
  options.width = options.height = 72;
  options.spp = 4;
  options.reconstruct = Switch::on;
  const auto rendered = [&](float unit) {
    Scene scene = standard_scene("cornell_box");
    for (Material& m : scene.materials) m.ke *= double{unit};
    return image_of(render(scene, options).film);
  };
  const Image image = rendered(1);
  for (const float unit : {0x1p-70f, 0x1p-40f, 0x1p30f, 0x1p90f}) {
    CAPTURE(unit);
    const Image other = rendered(unit);
    bool same = true;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) same &= other.pixels[i] == image.pixels[i] * unit;
    CHECK(same);
  }
}

TEST_CASE("reconstruction has no bias, which it has with weights of the same samples") {
  Mean proper[3], own[3];
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    const TiledFilm film = noisy_film(100 + seed, 8);
    const Vec3d correction = mean_of(image_of(film)) - mean_of(film.image());
    const PixelPlanes same = corrections(film.differences(), 1, WeightsOf::same_half)[0];
    for (int c = 0; c < 3; ++c) {
      proper[c].add(correction[c]);
      own[c].add(mean_of(same[static_cast<std::size_t>(c)], film.width(), film.height()));
    }
  }
  for (int c = 0; c < 3; ++c) {
    CAPTURE(c, proper[c].mean(), proper[c].error(), own[c].mean(), own[c].error());
    CHECK(std::abs(proper[c].mean()) < 4.5 * proper[c].error());  // a false alarm in 150,000
    CHECK(own[c].mean() < -6 * own[c].error());
  }
}
