#pragma once

#include <cmath>
#include <cstdint>

#include "castray/film.h"
#include "castray/image.h"
#include "core/sequences.h"

/// An image of radiance from 2^-10 to 2^6, each component different, the same for the same arguments.
inline castray::Image test_image(int width, int height, std::uint32_t seed = 1) {
  castray::Image image(width, height);
  std::uint32_t i = castray::hash32(seed);
  for (castray::Vec3f& pixel : image.pixels)
    for (int c = 0; c < 3; ++c)
      pixel[c] = std::exp2(16 * static_cast<float>(castray::hash32(++i)) * 0x1p-32f - 10);
  return image;
}

/// A film of samples first <= i < first + count, a function of pixel and index.
inline castray::Film test_film(int width, int height, std::uint32_t first, std::uint32_t count) {
  castray::Film film({width, height, 0, 0, width, height}, 64);
  for (std::uint32_t i = first; i < first + count; ++i) {
    const castray::Image samples = test_image(width, height, i);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) film.add(x, y, samples.at(x, y));
  }
  film.samples = {{first, count}};
  film.key = "scene=test; seed=0";
  return film;
}
