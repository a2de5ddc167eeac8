#include "render/prepared_scene.h"

#include "reference/reference.h"
#include "wavefront/wavefront.h"

namespace castray {

PreparedScene PreparedAccess::prepare(const Scene& scene, const RenderOptions& options, Fault fault) {
  auto data = std::make_unique<PreparedScene::Data>();
  data->facts = facts_of(scene);
  data->job = make_job(data->facts, options, fault);
  data->integrator = data->job.options.integrator == Integrator::wavefront
                         ? prepare_wavefront(scene, data->job)
                         : prepare_reference(scene, data->job);
  return PreparedScene(std::move(data));
}

PreparedScene::PreparedScene(std::unique_ptr<const Data> data) : data_(std::move(data)) {}
PreparedScene::PreparedScene(const Scene& scene, const RenderOptions& options)
    : PreparedScene(PreparedAccess::prepare(scene, options, Fault::none)) {}
PreparedScene::PreparedScene(PreparedScene&&) noexcept = default;
PreparedScene& PreparedScene::operator=(PreparedScene&&) noexcept = default;
PreparedScene::~PreparedScene() = default;

}  // namespace castray
