#include "tracers.h"

#include <optional>

#include "castray/error.h"
#include "geometry/facets.h"
#include "geometry/instance_bvh.h"
#include "geometry/list.h"
#include "geometry/wide_bvh.h"
#include "instanced.h"
#include "scene/scene_builder.h"
#include "wavefront/choose_kernel.h"

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
    rays.closest([&](const RayBatch& batch) { kernel_.bvh_closest(bvh_.view(), batch); }, first, count, hits);
  }
  void occluded(const RayArrays& rays, std::size_t first, std::size_t count,
                std::uint8_t* occluded) const override {
    rays.occluded([&](const ShadowBatch& batch) { kernel_.bvh_occluded(bvh_.view(), batch); }, first, count,
                  occluded);
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
    builder.add(std::move(mesh), "mesh");
    scene_ = builder.finish();
    facets_ = make_facets(scene_);
    exact_.emplace(scene_, facets_.facets);
    return {.triangles = mesh_.count};
  }
  void closest(const RayArrays& rays, std::size_t first, std::size_t count, Hit<float>* hits) const override {
    in_scene(rays, first, count, 1)
        .closest([&](const RayBatch& batch) { kernel_.facets_closest(list(), list_slack, batch); }, 0, count,
                 hits);
  }
  void occluded(const RayArrays& rays, std::size_t first, std::size_t count,
                std::uint8_t* occluded) const override {
    in_scene(rays, first, count, 4)  // longer than any segment in the scene
        .occluded([&](const ShadowBatch& batch) { kernel_.facets_occluded(list(), segment_slack, batch); }, 0,
                  count, occluded);
  }

 private:
  FacetList list() const {
    FacetList list = facets_.list();
    list.exact = exact_->view();
    return list;
  }

  /// Rays in scene space, with directions of the given length.
  RayArrays in_scene(const RayArrays& rays, std::size_t first, std::size_t count, double norm) const {
    RayArrays moved;
    for (std::size_t i = first; i < first + count; ++i) {
      const Ray<float> ray = rays[i];
      moved.add({Vec3f(scene_.to_scene(Vec3d(ray.origin))), Vec3f(normalize(Vec3d(ray.direction)) * norm)});
    }
    return moved;
  }

  MeshView mesh_;
  const KernelApi& kernel_;
  Scene scene_;
  Facets facets_;
  std::optional<FacetsInDouble> exact_;
};

class InstanceTracer : public Tracer {
 public:
  InstanceTracer(Scene scene, const KernelApi& kernel) : scene_(std::move(scene)), kernel_(kernel) {}

  std::string name() const override { return std::string("instances ") + kernel_.name; }
  BvhStats build(int threads) override {
    tree_.emplace(InstanceBvh::build(scene_, threads, BuildQuality::fast));
    return tree_->stats();
  }
  void closest(const RayArrays& rays, std::size_t first, std::size_t count, Hit<float>* hits) const override {
    rays.closest([&](const RayBatch& batch) { kernel_.instances_closest(tree_->view(), batch); }, first,
                 count, hits);
  }
  void occluded(const RayArrays& rays, std::size_t first, std::size_t count,
                std::uint8_t* occluded) const override {
    rays.occluded([&](const ShadowBatch& batch) { kernel_.instances_occluded(tree_->view(), batch); }, first,
                  count, occluded);
  }

 private:
  Scene scene_;
  const KernelApi& kernel_;
  std::optional<InstanceBvh> tree_;
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
  if (accel == "instance")
    return make_instance_tracer(as_instances(scene_of(mesh), {kinds_of_places().front()}), kernel);
  if (accel == "list") return std::make_unique<PlainTracer<TriangleList>>(mesh);
  return std::make_unique<WideTracer>(mesh, kernel, quality);
}

std::unique_ptr<Tracer> make_instance_tracer(Scene scene, const KernelApi& kernel) {
  return std::make_unique<InstanceTracer>(std::move(scene), kernel);
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
