#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace castray {

/// Zeros, aligned to cache lines; great blocks to large pages, which the system is asked for: they are filled
/// and found sooner, by the thread that uses a page first. Throws std::bad_alloc.
void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes);

/// What a block of so many bytes takes of memory.
std::size_t bytes_in_large_pages(std::size_t bytes);

/// For vectors of numbers of every pixel, whose size is set once: what `resize` adds is zero as memory is
/// when it is new, and is not written a second time.
template <class T>
struct LargeAllocator {
  using value_type = T;

  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}

  T* allocate(std::size_t count) { return static_cast<T*>(allocate_large(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) { free_large(memory, count * sizeof(T)); }
  template <class U>
  void construct(U*) {}  // zero already
  template <class U, class... Arguments>
  void construct(U* to, Arguments&&... arguments) {
    ::new (static_cast<void*>(to)) U(std::forward<Arguments>(arguments)...);
  }
  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace castray
