#include "kernels/bvh.h"
#include "kernels/render_tiles.h"
#include "kernels/tiles.h"

namespace castray::CASTRAY_ISA {

#define CASTRAY_TEXT_(x) #x
#define CASTRAY_TEXT(x) CASTRAY_TEXT_(x)

const KernelApi& kernel_api() {
  static const KernelApi api{CASTRAY_TEXT(CASTRAY_ISA),
                             width,
                             sizeof(Scratch),
                             {render_tiles_list_diffuse, render_tiles_bvh_diffuse, render_tiles_list,
                              render_tiles_bvh, nullptr, nullptr, nullptr, render_tiles_bvh_detail},
                             bvh_closest,
                             bvh_occluded};
  return api;
}

}  // namespace castray::CASTRAY_ISA
