#pragma once

#include <stdint.h>

// What the program and the kernels exchange: plain data and a table of functions, the same for every
// instruction set.

namespace castray {

/// The functions of one instruction set.
struct KernelApi {
  const char* name;  ///< "scalar", "sse4", "avx2", "avx512"
  int width;         ///< lanes
};

namespace scalar {
const KernelApi& kernel_api();
}
namespace sse4 {
const KernelApi& kernel_api();
}
namespace avx2 {
const KernelApi& kernel_api();
}
namespace avx512 {
const KernelApi& kernel_api();
}

}  // namespace castray
