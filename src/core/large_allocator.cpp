#include "castray/large_allocator.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace castray {

namespace {

constexpr std::size_t cache_line = 64, large_page = std::size_t{1} << 21;

std::size_t alignment_of(std::size_t bytes) { return bytes >= 2 * large_page ? large_page : cache_line; }

}  // namespace

void* allocate_large(std::size_t bytes) {
  const std::size_t alignment = alignment_of(bytes);
  void* memory = std::aligned_alloc(alignment, bytes_in_large_pages(bytes));
  if (!memory) throw std::bad_alloc();
  if (alignment == large_page) madvise(memory, bytes, MADV_HUGEPAGE);  // without it pages are small
  return memory;
}

void free_large(void* memory) { std::free(memory); }

std::size_t bytes_in_large_pages(std::size_t bytes) {
  const std::size_t alignment = alignment_of(bytes);
  return (bytes + alignment - 1) / alignment * alignment;
}

}  // namespace castray
