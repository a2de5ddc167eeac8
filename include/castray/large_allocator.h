#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace castray {

/// Zeros, aligned to cache lines; great blocks to large pages, which the system is asked for: they are filled
/// and found sooner, by the thread that uses a page first. Throws std::bad_alloc.
void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes);

/// What a block of so many bytes takes of memory.
std::size_t bytes_in_large_pages(std::size_t bytes);

/// Numbers of every pixel, zero at first, as memory is when it is new. A std::vector would go over all of
/// them once more to make and to end each.
template <class T>
class LargeVector {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  LargeVector() = default;
  explicit LargeVector(std::size_t size)
      : values_(size > 0 ? static_cast<T*>(allocate_large(size * sizeof(T))) : nullptr), size_(size) {}
  LargeVector(const LargeVector& other) : LargeVector(other.size_) {
    std::copy_n(other.values_, size_, values_);
  }
  LargeVector(LargeVector&& other) noexcept { swap(other); }
  LargeVector& operator=(LargeVector other) noexcept {
    swap(other);
    return *this;
  }
  ~LargeVector() {
    if (values_) free_large(values_, size_ * sizeof(T));
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return values_; }
  const T* data() const { return values_; }
  T* begin() { return values_; }
  const T* begin() const { return values_; }
  T* end() { return values_ + size_; }
  const T* end() const { return values_ + size_; }
  T& operator[](std::size_t i) { return values_[i]; }
  const T& operator[](std::size_t i) const { return values_[i]; }
  friend bool operator==(const LargeVector& a, const LargeVector& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  void swap(LargeVector& other) noexcept {
    std::swap(values_, other.values_);
    std::swap(size_, other.size_);
  }

  T* values_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace castray
