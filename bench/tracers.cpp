#include "tracers.h"

#include <optional>

#include "accel/list.h"
#include "accel/wide_bvh.h"
#include "castray/error.h"
#include "core/error_bounds.h"
#include "integrate/facets.h"
#include "integrate/wavefront.h"
#include "scene/scene_builder.h"

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

/// The flat list of the renderer's kernels: the mesh, and rays, as a scene of that mesh alone has them, moved
/// to its middle. Hits have neither triangle nor barycentrics: facets are made of one or two triangles.
class FacetTracer : public Tracer {
 public:
  FacetTracer(const MeshView& mesh, const KernelApi& kernel) : mesh_(mesh), kernel_(kernel) {}

  std::string name() const override { return std::string("facets ") + kernel_.name; }
  BvhStats build(int) override {
    SceneBuilder builder;
    Mesh mesh;
    for (std::uint32_t i = 0; i < mesh_.count; ++i) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const std::uint32_t v : mesh_.triangles[i]) mesh.positions.emplace_back(mesh_.positions[v]);
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    mesh.triangle_material.assign(mesh_.count, builder.add_material({}));
    builder.add(std::move(mesh));
    scene_ = builder.finish();
    facets_ = make_facets(scene_);
    exact_.emplace(scene_, facets_.facets);
    return {.triangles = mesh_.count};
  }
  void closest(const RayArrays& rays, std::size_t first, std::size_t count, Hit<float>* hits) const override {
    const Local local(*this, rays, first, count, 1);
    std::vector<float> t(count);
    std::vector<std::uint32_t> facet(count);
    const auto& n = local.number;
    FacetList list = facets_.list();
    list.exact = exact_->view();
    kernel_.facets_closest(
        list, list_slack,
        {n[0].data(), n[1].data(), n[2].data(), n[3].data(), n[4].data(), n[5].data(), nullptr, t.data(),
         facet.data(), nullptr, nullptr, static_cast<std::uint32_t>(count)});
    for (std::size_t i = 0; i < count; ++i) hits[i] = {t[i], facet[i], 0, 0};
  }
  void occluded(const RayArrays& rays, std::size_t first, std::size_t count,
                std::uint8_t* occluded) const override {
    const Local local(*this, rays, first, count, 4);  // longer than any segment in the scene
    const auto& n = local.number;
    kernel_.facets_occluded(facets_.list(), segment_slack,
                            {n[0].data(), n[1].data(), n[2].data(), n[3].data(), n[4].data(), n[5].data(),
                             nullptr, occluded, static_cast<std::uint32_t>(count)});
  }

 private:
  /// Rays in scene space, with directions of the given length.
  struct Local {
    std::vector<float> number[6];

    Local(const FacetTracer& tracer, const RayArrays& rays, std::size_t first, std::size_t count,
          double norm) {
      for (std::size_t i = first; i < first + count; ++i) {
        const Vec3d o = tracer.scene_.to_scene(Vec3d(rays[i].origin)), d(rays[i].direction);
        const Vec3d scaled = normalize(d) * norm;
        for (int c = 0; c < 3; ++c) {
          number[c].push_back(static_cast<float>(o[c]));
          number[3 + c].push_back(static_cast<float>(scaled[c]));
        }
      }
    }
  };

  MeshView mesh_;
  const KernelApi& kernel_;
  Scene scene_;
  Facets facets_;
  std::optional<FacetsInDouble> exact_;
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
  if (accel == "facets") return std::make_unique<FacetTracer>(mesh, kernel);
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
