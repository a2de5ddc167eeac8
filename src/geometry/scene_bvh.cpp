#include "geometry/scene_bvh.h"

#include <chrono>

#include "core/box.h"
#include "geometry/bounds.h"
#include "geometry/triangle.h"
#include "geometry/visit_leaves.h"

namespace castray {

namespace {

Box3d box_of(const MeshView& mesh) {
  Bounds bounds;
  for (std::uint32_t t = 0; t < mesh.count; ++t) bounds.add(triangle_bounds(mesh, t));
  return {Vec3d(to_vec3(bounds.lower)), Vec3d(to_vec3(bounds.upper))};
}

/// A box around an instance of what is in `box`, rounding to float included.
Bounds bounds_of(const SceneInstance& instance, const Box3d& box) {
  Box3d all;
  for (const Vec3d& corner : box.corners()) all.add(instance.point(corner));
  constexpr double rounding = 0x1p-23;
  const Vec3f low(all.lower - magnitude(all.lower) * rounding),
      high(all.upper + magnitude(all.upper) * rounding);
  return {load_point(low), load_point(high)};
}

}  // namespace

void SceneBvh::build_top(const Scene& scene, int threads) {
  std::vector<Box3d> boxes;
  for (const SharedMesh& mesh : scene.shared_meshes) boxes.push_back(box_of(mesh_of(scene, mesh)));
  std::vector<PrimRef> refs;
  for (const SceneInstance& instance : scene.instances) {
    refs.push_back({bounds_of(instance, boxes[instance.mesh]), static_cast<std::uint32_t>(refs.size())});
    instances_.push_back({Placed(instance), instance.mesh});
  }
  top_ = build_binary_tree(std::move(refs), {.threads = threads, .max_leaf = 1});
  stats_.nodes += static_cast<std::uint32_t>(2 * top_.pairs.size() + 1);
  stats_.bytes += top_.pairs.size() * sizeof(BvhPair) + instances_.size() * sizeof(Instance);
}

SceneBvh SceneBvh::build(const Scene& scene, int threads) {
  const auto start = std::chrono::steady_clock::now();
  SceneBvh all(Bvh::build(mesh_of(scene), threads));
  if (scene.instances.empty()) return all;
  for (const SharedMesh& mesh : scene.shared_meshes) {
    all.meshes_.push_back({Bvh::build(mesh_of(scene, mesh), threads), mesh.first});
    const BvhStats& more = all.meshes_.back().bvh.stats();
    all.stats_.triangles += more.triangles;
    all.stats_.nodes += more.nodes;
    all.stats_.bytes += more.bytes;
    all.stats_.depth = std::max(all.stats_.depth, more.depth);
  }
  all.build_top(scene, threads);
  all.stats_.depth += all.top_.depth;
  all.stats_.sah_cost = all.top_.sah_cost;
  all.stats_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return all;
}

template <bool any, class T>
Hit<T> SceneBvh::search_instances(const Ray<T>& ray, const HitFilter<T>& counts, const Hit<T>& so_far) const {
  Hit<T> hit = so_far;
  const Ray<double> in_scene{Vec3d(ray.origin), Vec3d(ray.direction)};
  double nearest = hit.found() ? double{hit.t} : double{ray.t_max};
  const auto slab = slab_test(in_scene, TriangleTest<double>(in_scene).main_axis(), top_);
  visit_leaves(top_, slab, nearest, [&](const BvhNode& leaf) {
    const std::uint32_t instance = top_.primitives[leaf.first];
    const Placed& place = instances_[instance].place;
    const Mesh& mesh = meshes_[instances_[instance].mesh];
    const auto to_scene = [&](const Hit<double>& h) {
      return Hit<T>{T(h.t), mesh.first + h.triangle, T(h.b1), T(h.b2), instance};
    };
    const Ray<double> inside{place.to_object(in_scene.origin), place.direction_to_object(in_scene.direction),
                             nearest};
    HitFilter<double> counts_inside;
    if (counts) counts_inside = [&](const Hit<double>& h) { return counts(to_scene(h)); };
    const Hit<double> found = mesh.bvh.closest(inside, counts_inside);
    if (found.found()) {
      hit = to_scene(found);
      nearest = any ? -1 : found.t;
    }
    return nearest;
  });
  return hit;
}

template <class T>
Hit<T> SceneBvh::closest(const Ray<T>& ray, const HitFilter<T>& counts) const {
  const Hit<T> hit = own_.closest(ray, counts);
  if (instances_.empty() || !is_traceable(ray)) return hit;
  return search_instances<false>(ray, counts, hit);
}

template <class T>
bool SceneBvh::occluded(const Ray<T>& ray, const HitFilter<T>& counts) const {
  if (own_.occluded(ray, counts)) return true;
  if (instances_.empty() || !is_traceable(ray)) return false;
  return search_instances<true>(ray, counts, Hit<T>()).found();
}

template Hit<float> SceneBvh::closest(const Ray<float>&, const HitFilter<float>&) const;
template Hit<double> SceneBvh::closest(const Ray<double>&, const HitFilter<double>&) const;
template bool SceneBvh::occluded(const Ray<float>&, const HitFilter<float>&) const;
template bool SceneBvh::occluded(const Ray<double>&, const HitFilter<double>&) const;

}  // namespace castray
