#pragma once

#include <string>

#include "castray/film.h"
#include "core/files.h"
#include "temporary_folder.h"

namespace castray::test {

/// What a .film of it holds.
inline std::string bytes(const Film& film) {
  const TemporaryFolder folder;
  write_film(folder / "x.film", film);
  return read_file(folder / "x.film");
}

}  // namespace castray::test
