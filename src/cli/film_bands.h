#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "castray/film.h"

namespace castray::cli {

/// A film of which some rows at a time are in memory.
struct BandedFilm {
  Window window;
  int band = 0;                              ///< rows at a time
  int margin = 0;                            ///< rows above and below that their image depends on
  std::function<Film(int y0, int y1)> rows;  ///< y0 <= y < y1 of the full image, which lie in the window
};

/// Rows above and below a band that are reconstructed with it, so that its own hardly depend on where it
/// ends.
inline constexpr int reconstruction_margin = 64;

/// How many rows of such a film, with their image and what is at work on them, fit in `bytes`; at least 1.
int rows_within(std::uint64_t bytes, std::size_t bytes_of_pixel, int width);

/// Writes the film's image, band by band. Throws InputError where an output is a .film.
void write_film_in_bands(const std::vector<std::filesystem::path>& outputs, const BandedFilm& film,
                         const Display& display, const std::function<Metadata(const Film& first)>& metadata,
                         int threads = 0);

}  // namespace castray::cli
