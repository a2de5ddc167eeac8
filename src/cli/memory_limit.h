#pragma once

#include <cstdint>
#include <string>

namespace castray::cli {

/// "4G", "512M", "64K" or bytes.
std::uint64_t parse_bytes(const std::string& flag, const std::string& text);
/// "12.5 MiB".
std::string bytes_text(std::uint64_t bytes);

/// What this program takes of the machine's memory without being asked: half of it.
std::uint64_t share_of_memory();

/// What the program has in memory at most, its own code and that of libraries included, until it asks for
/// more.
std::uint64_t bytes_of_program();

/// "a limit of 29.0 MiB: WHAT; give --memory-limit 73M or more", of which `least` bytes fit.
std::string more_is_needed(std::uint64_t limit, const std::string& what, std::uint64_t least);

/// From now on blocks of memory go back to the system when they are freed: none are kept for others, which
/// may need other sizes.
void return_freed_memory();

/// The program gets at most `bytes` in memory while this object lives, and so many threads: what asks for
/// more gets std::bad_alloc.
class MemoryLimit {
 public:
  MemoryLimit(std::uint64_t bytes, int threads);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  std::uint64_t former_ = 0;
};

}  // namespace castray::cli
