#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "wavefront/kernel_api.h"

namespace castray {

/// As kernels ask for it.
inline constexpr std::align_val_t scratch_alignment{64};
struct FreeScratch {
  void operator()(void* p) const { ::operator delete(p, scratch_alignment); }
};

/// Room for the results of a job.
struct TileBuffers {
  std::vector<float> radiance = std::vector<float>(3 * batch_size),
                     emitted = std::vector<float>(3 * batch_size);
  std::vector<std::uint32_t> place = std::vector<std::uint32_t>(2 * batch_size);

  TileResult result(bool with_emitted) {
    TileResult result{&place[0],
                      &place[batch_size],
                      {&radiance[0], &radiance[batch_size], &radiance[2 * batch_size]},
                      0,
                      0,
                      0,
                      0};
    for (std::size_t c = 0; with_emitted && c < 3; ++c) result.emitted[c] = &emitted[c * batch_size];
    return result;
  }
};

/// What a thread works in.
struct Workplace {
  std::unique_ptr<void, FreeScratch> scratch;
  TileBuffers tiles, repeats;

  explicit Workplace(const KernelApi& kernel)
      : scratch(::operator new(kernel.scratch_bytes, scratch_alignment)) {
    std::memset(scratch.get(), 0, kernel.scratch_bytes);  // indices past the end of a wave must be valid ones
  }
};

}  // namespace castray
