#include "cli/film_bands.h"

#include <algorithm>

#include "castray/error.h"
#include "castray/image_bands.h"
#include "cli/memory_limit.h"

namespace castray::cli {

int least_band(int margin, int height) { return std::min(std::max(margin, tile_side), height); }

std::optional<int> band_within(std::uint64_t bytes, int margin, int height,
                               const std::function<std::uint64_t(int rows)>& bytes_of_rows) {
  const auto fits = [&](int band) { return bytes_of_rows(std::min(band + 2 * margin, height)) <= bytes; };
  int band = least_band(margin, height), too_many = height + 1;
  if (!fits(band)) return std::nullopt;
  while (too_many - band > 1) {
    const int between = band + (too_many - band) / 2;
    (fits(between) ? band : too_many) = between;
  }
  return band == height ? band : band / tile_side * tile_side;
}

void write_film_in_bands(const std::vector<std::filesystem::path>& outputs, const BandedFilm& film,
                         const Display& display, const std::function<Metadata(const Film& first)>& metadata,
                         int threads) {
  for (const auto& output : outputs)
    if (is_film_format(output))
      throw InputError({output.string()},
                       "a film is written as a whole only; raise --memory-limit, or write an image");
  return_freed_memory();
  const Window& window = film.window;
  Metadata told;
  const auto rows = [&](int y0, int y1) {
    const int first = std::max(y0 - film.margin, 0), last = std::min(y1 + film.margin, window.height());
    const Film& part = film.rows(window.y0 + first, window.y0 + last);
    if (y0 == 0) told = metadata(part);
    Image image = image_of(part, threads);
    if (film.margin == 0) return image;
    Image inner(image.width, y1 - y0);
    std::copy_n(&image.at(0, y0 - first), inner.pixels.size(), inner.pixels.begin());
    return inner;
  };
  write_image_in_bands(outputs, window.width(), window.height(), film.band, rows, display,
                       [&] { return told; });
}

}  // namespace castray::cli
