#pragma once

#include <cstddef>
#include <memory>

namespace castray {

/// Unwritten memory, aligned to cache lines; to large pages where it is large, as random access to many small
/// ones would wait for their translation.
class BlockArray {
 public:
  BlockArray() = default;
  explicit BlockArray(std::size_t bytes);

  char* data() { return data_.get(); }
  const char* data() const { return data_.get(); }
  std::size_t bytes() const { return bytes_; }

 private:
  struct Free {
    void operator()(char* data) const;
  };
  std::unique_ptr<char, Free> data_;
  std::size_t bytes_ = 0;
};

}  // namespace castray
