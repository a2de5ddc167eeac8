#pragma once

#include <memory>

#include "castray/render.h"
#include "plan/integrator.h"

namespace castray {

struct PreparedScene::Data {
  SceneFacts facts;
  Job job;  ///< of the options that it was prepared with
  std::unique_ptr<const PreparedIntegrator> integrator;
};

/// What the public interface of PreparedScene hides.
struct PreparedAccess {
  using Data = PreparedScene::Data;
  static const Data& data(const PreparedScene& scene) { return *scene.data_; }
  /// Ready to show a classic fault.
  static PreparedScene prepare(const Scene& scene, const RenderOptions& options, Fault fault);
};

}  // namespace castray
