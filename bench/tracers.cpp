#include "tracers.h"

#include "accel/list.h"
#include "accel/wide_bvh.h"
#include "castray/error.h"
#include "integrate/wavefront.h"

namespace castray {
namespace {

class WideTracer : public Tracer {
 public:
  WideTracer(const MeshView& mesh, const KernelApi& kernel, BuildQuality quality)
      : mesh_(mesh), kernel_(kernel), quality_(quality) {}

  std::string name() const override { return std::string("wide ") + kernel_.name; }
  BvhStats build(int threads) override {
    bvh_ = WideBvh::build(mesh_, threads, quality_);
    return bvh_.stats();
  }
  void closest(const RayArrays& rays, std::size_t first, std::size_t count, Hit<float>* hits) const override {
    rays.closest(kernel_, bvh_.view(), first, count, hits);
  }
  void occluded(const RayArrays& rays, std::size_t first, std::size_t count,
                std::uint8_t* occluded) const override {
    rays.occluded(kernel_, bvh_.view(), first, count, occluded);
  }

 private:
  MeshView mesh_;
  const KernelApi& kernel_;
  BuildQuality quality_;
  WideBvh bvh_;
};

/// Bvh or TriangleList: one ray at a time, in plain C++.
template <class Accelerator>
class PlainTracer : public Tracer {
 public:
  explicit PlainTracer(const MeshView& mesh) : mesh_(mesh) {}

  std::string name() const override { return std::is_same_v<Accelerator, Bvh> ? "bvh2" : "list"; }
  BvhStats build(int threads) override {
    if constexpr (std::is_same_v<Accelerator, Bvh>) {
      accelerator_ = std::make_unique<Bvh>(Bvh::build(mesh_, threads));
      return accelerator_->stats();
    } else {
      accelerator_ = std::make_unique<TriangleList>(mesh_);
      return {.triangles = mesh_.count};
    }
  }
  void closest(const RayArrays& rays, std::size_t first, std::size_t count, Hit<float>* hits) const override {
    for (std::size_t i = 0; i < count; ++i) hits[i] = accelerator_->closest(rays[first + i]);
  }
  void occluded(const RayArrays& rays, std::size_t first, std::size_t count,
                std::uint8_t* occluded) const override {
    for (std::size_t i = 0; i < count; ++i) occluded[i] = accelerator_->occluded(rays[first + i]);
  }

 private:
  MeshView mesh_;
  std::unique_ptr<Accelerator> accelerator_;
};

}  // namespace

std::unique_ptr<Tracer> make_tracer(const std::string& accel, const MeshView& mesh, const KernelApi& kernel,
                                    BuildQuality quality) {
  if (accel == "bvh2") return std::make_unique<PlainTracer<Bvh>>(mesh);
  if (accel == "list") return std::make_unique<PlainTracer<TriangleList>>(mesh);
  return std::make_unique<WideTracer>(mesh, kernel, quality);
}

std::vector<const KernelApi*> available_kernels() {
  std::vector<const KernelApi*> kernels;
  for (const char* name : {"scalar", "sse4", "avx2", "avx512"}) {
    try {
      kernels.push_back(&choose_kernel(name));
    } catch (const InputError&) {
    }
  }
  return kernels;
}

}  // namespace castray
