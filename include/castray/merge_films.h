#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "castray/film.h"

namespace castray {

struct MergedFilm {
  Film film;
  /// What the films lack of the render that they are parts of, each readable: samples, pixels of the
  /// rectangle around all windows, samples of a film that was stopped within a pass. Samples can be known to
  /// be missing only if a film knows what was planned (see `Film::planned`), or if windows differ in them.
  std::vector<std::string> missing;
};

/// Adds films of one render: disjoint sample ranges, disjoint windows, or both. The same film for any order.
/// All files are checked before the first sum is read; then one at a time is in memory. Throws InputError
/// that names the files where two are of different renders, hold the same samples of the same window, or have
/// windows that overlap without being equal. `progress` is called with the number of films added.
MergedFilm merge_films(const std::vector<std::filesystem::path>& files,
                       const std::function<void(std::size_t)>& progress = {});

/// The sum of such films, made some rows at a time: no film need be in memory as a whole.
class MergedRows {
 public:
  /// Checks the films as `merge_films` does, checksums too. Throws InputError also where they keep
  /// replicates.
  explicit MergedRows(const std::vector<std::filesystem::path>& files);

  /// Around all films.
  const Window& window() const { return window_; }
  /// See MergedFilm.
  const std::vector<std::string>& missing() const { return missing_; }

  /// Rows y0 <= y < y1 of the full image.
  Film rows(int y0, int y1) const;

 private:
  struct Part {
    std::filesystem::path file;
    Window window;
  };
  std::vector<Part> parts_;
  Film sum_;  ///< of all rows: what it says of itself, of one pixel
  Window window_;
  std::vector<std::string> missing_;
};

}  // namespace castray
