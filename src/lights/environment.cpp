#include "lights/environment.h"

#include "core/put.h"
#include "materials/environment_image.h"

namespace castray {

namespace {

/// Appends the cumulative probabilities, from 0 to 1, of choosing by weights; uniform where all are 0. Their
/// sum is returned.
double append_cumulative(const std::vector<double>& weights, std::vector<float>& to) {
  double total = 0, sum = 0;
  for (const double w : weights) total += w;
  to.push_back(0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += total > 0 ? weights[i] / total : 1 / static_cast<double>(weights.size());
    to.push_back(i + 1 < weights.size() ? static_cast<float>(std::min(sum, 1.0)) : 1.f);
  }
  return total;
}

}  // namespace

Environment::Environment(const Scene& scene) : constant_(scene.environment) {
  if (!scene.environment_image.used() || !(max_component(scene.environment) > 0)) return;
  const Texture& image = scene.textures[static_cast<std::size_t>(scene.environment_image.texture)];
  width_ = image.width, height_ = image.height;
  const double turn = scene.environment_image.rotation / 360;
  turn_ = turn - std::floor(turn);
  radiance_ = environment_radiance(scene);
  columns_.reserve(static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_));
  std::vector<double> row_weights, weights(static_cast<std::size_t>(width_));
  auto texel = radiance_.begin();
  for (int y = 0; y < height_; ++y) {
    for (double& w : weights) w = luminance(Vec3d(*texel++));
    row_weights.push_back(append_cumulative(weights, columns_) * share_of_row(y, height_));
  }
  append_cumulative(row_weights, rows_);
}

EnvironmentTable Environment::table() const {
  EnvironmentTable table{};
  put(table.constant, constant_);
  table.shines = max_component(constant_) > 0;
  if (!is_sampled()) return table;
  table.width = static_cast<std::uint32_t>(width_);
  table.height = static_cast<std::uint32_t>(height_);
  table.turn = static_cast<float>(turn_);
  table.radiance = &radiance_[0].x;
  table.rows = rows_.data();
  table.columns = columns_.data();
  return table;
}

}  // namespace castray
