#pragma once

#include <optional>
#include <vector>

#include "castray/render.h"
#include "castray/scene.h"
#include "geometry/facets.h"
#include "geometry/instance_bvh.h"
#include "geometry/wide_bvh.h"
#include "lights/arrival_guide.h"
#include "lights/emission_guide.h"
#include "lights/environment.h"
#include "lights/light_table.h"
#include "materials/coverage.h"
#include "materials/coverage_cells.h"
#include "materials/kernel_materials.h"
#include "plan/plan.h"
#include "wavefront/kernel_api.h"

namespace castray {

/// A scene laid out for the kernels. `view` points into the other members and into the scene: not copyable.
struct KernelSceneData {
  KernelSceneData(const Scene& scene, const Plan& plan, int width, int height, int threads);
  KernelSceneData(const KernelSceneData&) = delete;
  KernelSceneData& operator=(const KernelSceneData&) = delete;

  /// Makes the choice of lights know regions.
  void use(LightRegionTable regions, const Scene& scene);

  /// Leads light paths to mirrors and glass.
  void use(EmissionGuide guide);

  /// Leads paths from the camera to caustics that they see by way of mirrors and glass.
  void use(ArrivalGuide guide);

  bool is_list() const { return !bvh && !instances; }

  Facets facets;                              ///< of a list
  std::optional<FacetsInDouble> edges;        ///< of a list
  std::optional<WideBvh> bvh;                 ///< of a tree
  std::optional<WideBvh> rim;                 ///< of a tree's closed surface
  std::optional<InstanceBvh> instances;       ///< of instances
  std::vector<std::uint32_t> material_words;  ///< Scene::triangle_material, two in a word
  Coverage coverage;
  CoverageCells coverage_cells;
  KernelMaterials materials;
  LightTable lights;
  std::vector<MirroredLight> mirrored;
  EmissionGuide emission;
  ArrivalGuide arrivals;
  Environment environment;
  std::vector<KernelDelta> deltas;
  KernelScene view{};

 private:
  void build_tree(const Scene& scene, BuildQuality quality, int threads);
};

/// Makes a camera that of the view, for an image of this size.
void look_through(KernelScene& view, const Camera& camera, int width, int height);

}  // namespace castray
