#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "castray/film.h"

namespace castray::cli {

/// The .film in which a long render saves its sums now and then, and goes on from after it was ended. The one
/// saved before it is kept beside it (see `previous_checkpoint`).
class Checkpoint {
 public:
  /// Throws InputError if `file` is no good place, or has a film that is not to be resumed.
  Checkpoint(const std::filesystem::path& file, double seconds_between, bool resume);

  /// The film to go on from, if there is one. Where the last one is missing or damaged, the one before it,
  /// with a warning on stderr. Throws InputError if neither can be read.
  std::optional<Film> film_to_resume() const;

  void save(const Film& film);
  /// Saves if that was last done long enough ago.
  void save_if_due(const Film& film);

  const std::filesystem::path& file() const { return file_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::filesystem::path file_, previous_;
  std::chrono::duration<double> between_;
  bool resume_;
  Clock::time_point saved_ = Clock::now();
};

}  // namespace castray::cli
