#include "cli/checkpoint.h"

#include <fmt/format.h>

#include "castray/error.h"
#include "castray/image.h"

namespace castray::cli {

namespace fs = std::filesystem;

namespace {

/// The file itself where its name is a symbolic link: the previous one is kept in the same folder.
fs::path resolved(const fs::path& file) {
  std::error_code error;
  const fs::path target = fs::weakly_canonical(file, error);
  return !error && fs::is_symlink(file, error) ? target : file;
}

}  // namespace

Checkpoint::Checkpoint(const fs::path& file, double seconds_between, bool resume)
    : file_(resolved(file)),
      previous_(previous_checkpoint(file_)),
      between_(seconds_between),
      resume_(resume) {
  if (!is_film_format(file)) throw InputError({file.string()}, "a checkpoint's name must end in .film");
  check_output_image(file);
  if (resume) return;
  for (const fs::path& present : {file_, previous_})
    if (fs::exists(present))
      throw InputError({present.string()},
                       "is there already and would be lost; go on from it with --resume, or remove it");
}

std::optional<Film> Checkpoint::film_to_resume() const {
  if (!resume_ || (!fs::exists(file_) && !fs::exists(previous_))) return std::nullopt;
  try {
    return read_film(file_);
  } catch (const InputError& error) {
    if (!fs::exists(previous_)) throw;
    Film previous = read_film(previous_);
    fmt::print(stderr, "castray: warning: {}; going on from {}\n", error.what(), previous_.string());
    return previous;
  }
}

void Checkpoint::save(const Film& film) {
  write_checkpoint(file_, film);
  saved_ = Clock::now();
}

void Checkpoint::save_if_due(const Film& film) {
  if (Clock::now() - saved_ < between_) return;
  saved_ = Clock::now();  // where it fails, too: not to be tried all the time
  save(film);
}

}  // namespace castray::cli
