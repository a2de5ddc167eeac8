#include "plan/memory_need.h"

#include <algorithm>

namespace castray {

namespace {

// All at least a tenth more than the most that was measured of six shapes (smooth and jagged closed ones,
// terrain, triangles at random, sticks, hair) of 1000 to 1200000 triangles, by one to four threads, in new
// and used heaps.

/// Bytes of a triangle: while its tree is built, and afterwards.
struct TreeBytes {
  std::uint64_t most, kept;
};

/// Of small trees what is freed meanwhile may not come back: the C library returns blocks of more than 32 MiB
/// at once, and a builder's largest have 32 bytes a triangle.
constexpr std::uint64_t small_tree = 1 << 20;  ///< triangles
constexpr TreeBytes small_fast_tree{165, 75}, fast_tree{130, 75}, cut_tree{500, 190}, reference_tree{195, 85};
constexpr std::uint64_t bytes_of_any_tree = 2 << 20;
constexpr std::uint64_t bytes_of_instance = 400;  ///< matrices, references, and nodes over it
constexpr std::uint64_t bytes_of_facet = 650;     ///< of a list, while pairs of triangles are found
constexpr std::uint64_t bytes_of_light = 800;     ///< of an emitting triangle: facet, light, light tree
constexpr std::uint64_t bytes_of_reference_light = 290;  ///< likewise
constexpr std::uint64_t bytes_of_texel = 16;             ///< of the environment: radiance and probability
constexpr std::uint64_t bytes_of_any_scene = 3 << 20;

std::uint64_t bytes_of_environment(const Scene& scene) {
  if (!scene.environment_image.used()) return 0;
  const Texture& image = scene.textures[static_cast<std::size_t>(scene.environment_image.texture)];
  return bytes_of_texel * static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
}

TreeBytes tree_bytes(const Plan& plan, std::uint64_t triangles, bool reference) {
  if (reference) return reference_tree;
  if (plan.build == BuildQuality::best) return cut_tree;
  return triangles > small_tree ? fast_tree : small_fast_tree;
}

}  // namespace

std::uint64_t bytes_to_prepare(const Scene& scene, const Plan& plan, Integrator integrator) {
  const bool reference = integrator == Integrator::reference;
  const std::uint64_t triangles = scene.triangles.size();
  const int most_sides = std::ranges::any_of(scene.materials, &Material::emits_backwards) ? 2 : 1;
  const std::uint64_t lights =
      scene.lights.size() * most_sides * (reference ? bytes_of_reference_light : bytes_of_light);
  const std::uint64_t always = bytes_of_any_scene + bytes_of_environment(scene);
  if (plan.list) return always + triangles * bytes_of_facet + lights;
  const TreeBytes tree = tree_bytes(plan, triangles, reference);
  const std::uint64_t instances = scene.instances.size() * bytes_of_instance;
  return always + bytes_of_any_tree + instances +
         std::max(triangles * tree.most, triangles * tree.kept + lights);
}

}  // namespace castray
