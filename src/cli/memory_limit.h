#pragma once

#include <cstdint>
#include <string>

#include "castray/film.h"

namespace castray::cli {

/// "4G", "512M", "64K" or bytes.
std::uint64_t parse_bytes(const std::string& flag, const std::string& text);
/// "12.5 MiB".
std::string bytes_text(std::uint64_t bytes);

/// What a render is known to take before it does.
struct MemoryNeed {
  std::uint64_t scene = 0;  ///< resident: the program, triangles, textures
  std::uint64_t film = 0;   ///< the sums of samples, at least
  std::string text() const;
};
MemoryNeed memory_need(const Window& window);

/// No more memory than this is handed out while this object lives: what asks for more gets std::bad_alloc.
class MemoryLimit {
 public:
  /// Throws InputError if `need` is more.
  MemoryLimit(std::uint64_t bytes, const MemoryNeed& need);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  std::uint64_t former_ = 0;
};

}  // namespace castray::cli
