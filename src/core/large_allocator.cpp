#include "castray/large_allocator.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

namespace castray {

namespace {

constexpr std::size_t cache_line = 64, page = 4096, large_page = std::size_t{1} << 21;

/// Blocks of at least 64 pages are whole pages of their own, all provided at once: one by one, as they are
/// used, takes several times as long. Of at least two large pages they begin at one.
std::size_t alignment_of(std::size_t bytes) {
  if (bytes >= 2 * large_page) return large_page;
  return bytes >= 64 * page ? page : cache_line;
}

void* map(std::size_t size, int flags) {
  void* all = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | flags, -1, 0);
  if (all == MAP_FAILED) throw std::bad_alloc();
  return all;
}

}  // namespace

void* allocate_large(std::size_t bytes) {
  const std::size_t size = bytes_in_large_pages(bytes);
  if (alignment_of(bytes) == cache_line) {
    void* memory = std::aligned_alloc(cache_line, size);
    if (!memory) throw std::bad_alloc();
    return std::memset(memory, 0, size);
  }
  if (alignment_of(bytes) == page) return map(size, MAP_POPULATE);
  const std::size_t more = size + large_page;
  char* const begin = static_cast<char*>(map(more, 0));
  const std::size_t before = -reinterpret_cast<std::uintptr_t>(begin) % large_page;
  if (before > 0) munmap(begin, before);
  munmap(begin + before + size, more - before - size);
  // without it pages are small; so are those of the rest, which else would take a large one
  madvise(begin + before, size / large_page * large_page, MADV_HUGEPAGE);
  return begin + before;
}

void free_large(void* memory, std::size_t bytes) {
  if (alignment_of(bytes) >= page)
    munmap(memory, bytes_in_large_pages(bytes));
  else
    std::free(memory);
}

std::size_t bytes_in_large_pages(std::size_t bytes) {
  const std::size_t unit = std::min(alignment_of(bytes), page);
  return (bytes + unit - 1) / unit * unit;
}

}  // namespace castray
