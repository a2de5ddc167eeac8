#pragma once

#include <vector>

#include "castray/render.h"
#include "castray/scene.h"
#include "integrate/facets.h"
#include "kernels/api.h"

namespace castray {

/// A scene laid out for the kernels. `view` points into the other members and into the scene: not copyable.
struct KernelSceneData {
  KernelSceneData(const Scene& scene, int width, int height);
  KernelSceneData(const KernelSceneData&) = delete;
  KernelSceneData& operator=(const KernelSceneData&) = delete;

  Facets facets;
  std::vector<KernelMaterial> materials;
  std::vector<KernelLight> lights;
  KernelScene view{};
};

}  // namespace castray
