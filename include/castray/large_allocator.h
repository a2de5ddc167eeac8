#pragma once

#include <cstddef>
#include <vector>

namespace castray {

/// Memory aligned to cache lines; for great blocks to large pages, which the system is asked for: they are
/// filled and found sooner. Throws std::bad_alloc.
void* allocate_large(std::size_t bytes);
void free_large(void* memory);

/// What a block of so many bytes takes of memory.
std::size_t bytes_in_large_pages(std::size_t bytes);

/// For vectors of numbers of every pixel.
template <class T>
struct LargeAllocator {
  using value_type = T;

  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}

  T* allocate(std::size_t count) { return static_cast<T*>(allocate_large(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t) { free_large(memory); }
  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace castray
