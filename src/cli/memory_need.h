#pragma once

#include <cstdint>
#include <string>

#include "castray/film.h"
#include "castray/scene.h"
#include "cli/render_flags.h"

namespace castray::cli {

/// What a render takes at most, in bytes, before it does.
struct MemoryNeed {
  std::uint64_t scene = 0;        ///< the program, and triangles and textures as they are read
  std::uint64_t preparation = 0;  ///< tree and lights while they are built
  std::uint64_t work = 0;         ///< of threads
  std::uint64_t films = 1;        ///< that are there at once
  std::uint64_t more_pixel = 0;   ///< of a pixel of passes and replicates
  int width = 0, height = 0, threads = 1;
  Film like;  ///< a film of one pixel that keeps what the image's does

  int margin() const;
  std::uint64_t fixed() const { return scene + preparation + work; }
  /// Of so many rows of films, passes and replicates included.
  std::uint64_t film_rows(int count) const;
  /// Of these with their image.
  std::uint64_t rows(int count) const;
  std::uint64_t all() const { return fixed() + rows(height); }
  /// The least with which the image is rendered in bands.
  std::uint64_t in_least_bands() const;
  std::string text() const;
};

/// Measures what the program has in memory now, with the scene read, and adds what is to come.
MemoryNeed memory_need(const Scene& scene, const RenderRequest& request);

}  // namespace castray::cli
