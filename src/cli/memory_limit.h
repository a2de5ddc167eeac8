#pragma once

#include <cstdint>
#include <string>

#include "castray/render_options.h"
#include "castray/scene.h"
#include "cli/film_bands.h"

namespace castray::cli {

/// "4G", "512M", "64K" or bytes.
std::uint64_t parse_bytes(const std::string& flag, const std::string& text);
/// "12.5 MiB".
std::string bytes_text(std::uint64_t bytes);

/// What this program takes of the machine's memory without being asked: half of it.
std::uint64_t share_of_memory();

/// What a render is known to take before it does, in bytes.
struct MemoryNeed {
  std::uint64_t scene = 0;        ///< resident: the program, triangles, textures
  std::uint64_t preparation = 0;  ///< about, at most: tree and lights while they are built
  std::size_t film_pixel = 0;     ///< of a pixel of the film: sums, splats, differences
  std::uint64_t pixels = 0;
  bool differences = false;  ///< are kept by the film
  int margin() const { return differences ? reconstruction_margin : 0; }
  std::uint64_t film() const { return film_pixel * pixels; }
  std::uint64_t all() const { return scene + preparation + film(); }
  std::string text() const;
};
MemoryNeed memory_need(const Scene& scene, const RenderOptions& options);

/// No more memory than this is handed out while this object lives: what asks for more gets std::bad_alloc.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  std::uint64_t former_ = 0;
};

}  // namespace castray::cli
