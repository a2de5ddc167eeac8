#pragma once

#include <algorithm>
#include <array>

#include "castray/film.h"
#include "core/sequences.h"

namespace castray::test {

/// The grid of tiles of one sample, shifted by chance.
struct Tiles {
  int shift_x, shift_y, columns, rows;

  Tiles(const Window& window, std::uint32_t sample)
      : shift_x(static_cast<int>(hash32(sample + 77) % 8)),
        shift_y(static_cast<int>(hash32(sample + 77) / 8 % 8)),
        columns(window.full_width / 8 + 2),
        rows(window.full_height / 8 + 2) {}
};

/// A film with differences, to which samples of the whole image are added.
class TiledFilm : public Film {
 public:
  explicit TiledFilm(const Window& window) : Film(window, 8) {
    key = "scene=tiles";
    keep_differences();
  }

  /// `value(x, y)`: the radiance of each pixel.
  template <class Value>
  void add_sample(std::uint32_t sample, Value value) {
    const Tiles tiles(window(), sample);
    for (int row = 0; row < tiles.rows; ++row)
      for (int column = 0; column < tiles.columns; ++column)
        add_tile(sample, column * 8 - tiles.shift_x, row * 8 - tiles.shift_y, value);
  }

 private:
  template <class Value>
  void add_tile(std::uint32_t sample, int left, int top, Value value) {
    std::array<float, 64> radiance[3] = {}, dark = {};
    TileSamples tile{.x = left, .y = top, .sample = sample};
    for (int c = 0; c < 3; ++c) {
      tile.radiance[c] = radiance[c].data();
      tile.emitted[c] = dark.data();
    }
    const Window& w = window();
    for (int i = 0; i < 64; ++i) {
      const int x = left + i % 8, y = top + i / 8;
      if (x < 0 || x >= w.full_width || y < 0 || y >= w.full_height) continue;
      const Vec3f colour = value(x, y);
      for (int c = 0; c < 3; ++c) radiance[c][static_cast<std::size_t>(i)] = colour[c];
      tile.smooth |= std::uint64_t{1} << i;
      if (x >= w.x0 && x < w.x1 && y >= w.y0 && y < w.y1) tile.kept |= std::uint64_t{1} << i;
    }
    add({&tile, 1}, std::max(top, w.y0), std::min(top + 8, w.y1));
  }
};

}  // namespace castray::test
