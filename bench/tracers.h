#pragma once

#include <memory>
#include <string>
#include <vector>

#include "castray/render.h"
#include "geometry/bvh.h"
#include "geometry/ray_arrays.h"
#include "wavefront/kernel_api.h"

namespace castray {

/// An accelerator of any kind over a mesh that must outlive it, and how it traces rays.
class Tracer {
 public:
  virtual ~Tracer() = default;
  virtual std::string name() const = 0;
  virtual BvhStats build(int threads) = 0;
  /// Of rays [first, first + count), into `hits` from 0 on.
  virtual void closest(const RayArrays& rays, std::size_t first, std::size_t count,
                       Hit<float>* hits) const = 0;
  virtual void occluded(const RayArrays& rays, std::size_t first, std::size_t count,
                        std::uint8_t* occluded) const = 0;
};

/// `accel`: wide, bvh2, list, instance, a turned one, or facets, which tells whether something is hit but not
/// which triangle; `kernel` is for all but bvh2 and list, `quality` for wide.
std::unique_ptr<Tracer> make_tracer(const std::string& accel, const MeshView& mesh, const KernelApi& kernel,
                                    BuildQuality quality = BuildQuality::fast);

/// All of a scene's triangles are in its instances.
std::unique_ptr<Tracer> make_instance_tracer(Scene scene, const KernelApi& kernel);

/// The kernels that this processor can run.
std::vector<const KernelApi*> available_kernels();

}  // namespace castray
