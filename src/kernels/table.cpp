#include "kernels/api.h"
#include "kernels/lanes.h"

namespace castray::CASTRAY_ISA {

#define CASTRAY_TEXT_(x) #x
#define CASTRAY_TEXT(x) CASTRAY_TEXT_(x)

const KernelApi& kernel_api() {
  static constexpr KernelApi api{CASTRAY_TEXT(CASTRAY_ISA), width};
  return api;
}

}  // namespace castray::CASTRAY_ISA
