#include "geometry/instance_bvh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "geometry/bvh_build.h"
#include "geometry/collapse.h"
#include "geometry/placement.h"

namespace castray {

namespace {

KernelInstance kernel_instance(const SceneInstance& at) {
  const Placed place(at);
  KernelInstance out{{}, {}, {at.translation.x, at.translation.y, at.translation.z}, at.mesh};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      out.to_scene[i][k] = at.rows[i][k];
      out.to_object[i][k] = static_cast<float>(place.to_object_row(i)[k]);
    }
  return out;
}

/// The greatest sum of a row of |to_scene| |to_object|: how much the box of an error grows on the way to an
/// object's space and back.
float growth(const KernelInstance& instance) {
  float most = 1;
  for (const auto& row : instance.to_scene) {
    float sum = 0;
    for (int k = 0; k < 3; ++k)
      for (const float entry : instance.to_object[k]) sum += std::abs(row[k] * entry);
    most = std::max(most, sum);
  }
  return most;
}

/// Boxes that together hold an object: those of the first two levels of its tree.
void add_boxes(const WideBvhView& bvh, std::uint32_t child, int levels, const Bounds& box,
               std::vector<Bounds>& boxes) {
  if (child & leaf_flag || levels == 0) {
    boxes.push_back(box);
    return;
  }
  const auto& node = *reinterpret_cast<const WideNode*>(
      bvh.blocks + static_cast<std::uint64_t>(child / child_unit) * block_bytes);
  for (int i = 0; i < bvh_width; ++i) {
    if (!(node.lower[0][i] <= node.upper[0][i])) continue;
    Bounds inner;
    inner.lower = {node.lower[0][i], node.lower[1][i], node.lower[2][i], 0};
    inner.upper = {node.upper[0][i], node.upper[1][i], node.upper[2][i], 0};
    add_boxes(bvh, node.child[i], levels - 1, inner, boxes);
  }
}

/// None of an object without triangles, which no instance places.
std::vector<Bounds> boxes_of(const WideBvhView& bvh) {
  std::vector<Bounds> boxes;
  if (bvh.triangles == 0) return boxes;
  Bounds all;
  all.lower = {bvh.lower[0], bvh.lower[1], bvh.lower[2], 0};
  all.upper = {bvh.upper[0], bvh.upper[1], bvh.upper[2], 0};
  add_boxes(bvh, bvh.root, 2, all, boxes);
  return boxes;
}

/// Where an instance's points may lie in scene space, rounding included.
Bounds bounds_of(const KernelInstance& instance, const std::vector<Bounds>& boxes) {
  Bounds all;
  const float rounding = growth(instance) * 0x1p-21f;
  for (const Bounds& box : boxes) {
    const Vec3f lower = to_vec3(box.lower), upper = to_vec3(box.upper);
    float low[3], high[3];
    for (int i = 0; i < 3; ++i) {
      float middle = instance.translation[i], half = 0;
      for (int k = 0; k < 3; ++k) {
        middle += instance.to_scene[i][k] * (lower[k] / 2 + upper[k] / 2);
        half += std::abs(instance.to_scene[i][k]) * (upper[k] / 2 - lower[k] / 2);
      }
      half += (std::abs(middle) + half + std::abs(instance.translation[i])) * rounding;
      low[i] = middle - half;
      high[i] = middle + half;
    }
    all.add({low[0], low[1], low[2], 0}, {high[0], high[1], high[2], 0});
  }
  return all;
}

}  // namespace

void InstanceBvh::add_object(const MeshView& mesh, std::uint32_t first, int threads, BuildQuality quality) {
  const WideBvh& tree = trees_.emplace_back(WideBvh::build(mesh, threads, quality));
  objects_.push_back({tree.view(), first});
  stats_.triangles += mesh.count;
  stats_.nodes += tree.stats().nodes;
  stats_.bytes += tree.stats().bytes;
  stats_.depth = std::max(stats_.depth, tree.stats().depth);
}

void InstanceBvh::build_top(int threads) {
  std::vector<std::vector<Bounds>> boxes;
  for (const KernelObject& object : objects_) boxes.push_back(boxes_of(object.bvh));
  std::vector<PrimRef> refs(instances_.size());
  const auto count = static_cast<std::int64_t>(refs.size());
#pragma omp parallel for num_threads(threads)
  for (std::int64_t n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    refs[i] = {bounds_of(instances_[i], boxes[instances_[i].object]), static_cast<std::uint32_t>(n)};
  }
  const BinaryTree tree = build_binary_tree(std::move(refs), {.threads = threads, .max_leaf = 1});
  WideTree wide = collapse_singles(tree, threads);
  top_ = std::move(wide.blocks);
  top_view_ = {top_.data(), wide.root, static_cast<std::uint32_t>(instances_.size()), wide.depth, {}, {}};
  std::copy_n(tree.root.lower, 3, top_view_.lower);
  std::copy_n(tree.root.upper, 3, top_view_.upper);
  stats_.nodes += wide.nodes;
  stats_.sah_cost = tree.sah_cost;
  stats_.bytes += top_.bytes() + instances_.size() * sizeof(KernelInstance);
  depth_ = wide.depth + stats_.depth;
}

InstanceBvh InstanceBvh::build(const Scene& scene, int threads, BuildQuality quality) {
  constexpr std::size_t most_instances = std::size_t{1} << 26;  // vectors index their numbers with 31 bits
  if (scene.instances.size() >= most_instances)
    throw std::length_error("the scene has too many instances for one tree");
  const auto start = std::chrono::steady_clock::now();
  InstanceBvh bvh;
  for (const SharedMesh& mesh : scene.shared_meshes)
    bvh.add_object(mesh_of(scene, mesh), mesh.first, threads, quality);
  float most_growth = 1;
  for (const SceneInstance& i : scene.instances) {
    bvh.instances_.push_back(kernel_instance(i));
    most_growth = std::max(most_growth, growth(bvh.instances_.back()));
  }
  bvh.plain_ = static_cast<std::uint32_t>(scene.instances.size());
  if (const MeshView own = mesh_of(scene); own.count > 0) {
    bvh.add_object(own, 0, threads, quality);
    const auto object = static_cast<std::uint32_t>(scene.shared_meshes.size());
    bvh.instances_.push_back(kernel_instance({object, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}));
  }
  // 20 half ulps for the test in the object's space, 6 for rounding the ray on its way there, and as much
  // again for the sums that this is used in
  bvh.slack_ = most_growth * 52 * 0x1p-24f;
  bvh.build_top(threads);
  bvh.stats_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return bvh;
}

InstanceTree InstanceBvh::view() const {
  return {
      top_view_, objects_.data(), instances_.data(), static_cast<std::uint32_t>(instances_.size()), plain_,
      depth_,    slack_};
}

}  // namespace castray
