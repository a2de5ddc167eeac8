#pragma once

#include <array>
#include <deque>
#include <optional>
#include <vector>

#include "castray/render.h"
#include "castray/scene.h"
#include "geometry/facets.h"
#include "geometry/wide_bvh.h"
#include "lights/light_tree.h"
#include "render/plan.h"
#include "wavefront/kernel_api.h"

namespace castray {

/// A scene laid out for the kernels. `view` points into the other members and into the scene: not copyable.
struct KernelSceneData {
  KernelSceneData(const Scene& scene, const Plan& plan, int width, int height, int threads);
  KernelSceneData(const KernelSceneData&) = delete;
  KernelSceneData& operator=(const KernelSceneData&) = delete;

  Facets facets;                              ///< of a list
  std::optional<FacetsInDouble> edges;        ///< of a list
  std::optional<WideBvh> bvh;                 ///< of a tree
  std::vector<std::uint32_t> material_words;  ///< Scene::triangle_material, two in a word
  std::vector<KernelMaterial> materials;
  std::vector<KernelAlbedo> albedos;
  std::vector<std::vector<KernelMap>> maps;  ///< of each of `details`
  std::vector<KernelDetail> details;
  std::deque<std::array<std::uint8_t, 8>> small_images;  ///< of fewer than four bytes
  std::vector<KernelLight> lights;
  LightTree light_tree;  ///< where lights are chosen by importance
  KernelScene view{};

 private:
  void add_details(const Scene& scene);
  void add_lights(const Scene& scene, const Plan& plan, int threads);
};

}  // namespace castray
