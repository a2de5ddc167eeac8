#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "castray/film.h"

namespace castray::cli {

/// A film of which some rows at a time are in memory.
struct BandedFilm {
  Window window;
  int band = 0;    ///< rows at a time
  int margin = 0;  ///< rows above and below that their image depends on
  /// Rows y0 <= y < y1 of the full image, which lie in the window; they live until the next are asked for.
  std::function<const Film&(int y0, int y1)> rows;
};

/// Rows above and below a band that are reconstructed with it, so that its own hardly depend on where it
/// ends.
inline constexpr int reconstruction_margin = 64;

/// The fewest rows that a band of an image has: as many as a tile, and as a margin, so that no row is made
/// more than three times.
int least_band(int margin, int height);

/// The most rows of a band, whole tiles, so that those with their margins take at most `bytes`; none where
/// the least band takes more.
std::optional<int> band_within(std::uint64_t bytes, int margin, int height,
                               const std::function<std::uint64_t(int rows)>& bytes_of_rows);

/// Writes the film's image, band by band. Throws InputError where an output is a .film.
void write_film_in_bands(const std::vector<std::filesystem::path>& outputs, const BandedFilm& film,
                         const Display& display, const std::function<Metadata(const Film& first)>& metadata,
                         int threads = 0);

}  // namespace castray::cli
