#include "cli/film_bands.h"

#include <algorithm>

#include "castray/error.h"
#include "castray/image_bands.h"
#include "castray/scene.h"

namespace castray::cli {

int rows_within(std::uint64_t bytes, std::size_t bytes_of_pixel, int width) {
  constexpr std::uint64_t image = 3 * sizeof(float), copies = 3;  // of the film, and of the image in writers
  const std::uint64_t row = copies * (bytes_of_pixel + image) * static_cast<std::uint64_t>(width);
  return static_cast<int>(std::clamp<std::uint64_t>(bytes / row, 1, std::uint64_t{max_image_side}));
}

void write_film_in_bands(const std::vector<std::filesystem::path>& outputs, const BandedFilm& film,
                         const Display& display, const std::function<Metadata(const Film& first)>& metadata,
                         int threads) {
  for (const auto& output : outputs)
    if (is_film_format(output))
      throw InputError({output.string()},
                       "a film is written as a whole only; raise --memory-limit, or write an image");
  const Window& window = film.window;
  Metadata told;
  const auto rows = [&](int y0, int y1) {
    const int first = std::max(y0 - film.margin, 0), last = std::min(y1 + film.margin, window.height());
    const Film part = film.rows(window.y0 + first, window.y0 + last);
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
