#include "kernels/api.h"
#include "kernels/bvh.h"
#include "kernels/lanes.h"
#include "kernels/tiles.h"

namespace castray::CASTRAY_ISA {

#define CASTRAY_TEXT_(x) #x
#define CASTRAY_TEXT(x) CASTRAY_TEXT_(x)

const KernelApi& kernel_api() {
  static const KernelApi api{CASTRAY_TEXT(CASTRAY_ISA), width, scratch_bytes(), render_tiles,
                             bvh_closest, bvh_occluded};
  return api;
}

}  // namespace castray::CASTRAY_ISA
