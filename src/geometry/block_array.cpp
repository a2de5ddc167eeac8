#include "geometry/block_array.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace castray {

BlockArray::BlockArray(std::size_t bytes) : bytes_(bytes) {
  constexpr std::size_t large_page = std::size_t{1} << 21, line = 64;
  const bool large = bytes >= 2 * large_page;
  const std::size_t alignment = large ? large_page : line;
  data_.reset(
      static_cast<char*>(std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment)));
  if (!data_) throw std::bad_alloc();
  if (large) madvise(data_.get(), bytes, MADV_HUGEPAGE);  // a wish; without it all still works
}

void BlockArray::Free::operator()(char* data) const { std::free(data); }

}  // namespace castray
