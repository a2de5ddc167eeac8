#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "castray/scene.h"
#include "core/warp.h"
#include "lights/light_records.h"

namespace castray {

/// A direction to the environment.
template <class T>
struct EnvironmentSample {
  Vec3<T> w;  ///< unit
  Vec3<T> radiance;
  T pdf = 0;  ///< per solid angle; 0: no sample
};

/// Light from outside the scene. An image of it can be sampled: a texel by its luminance times its solid
/// angle (rows by their sums, then columns, each by inverting cumulative probabilities, so that stratified
/// numbers stay so), then a point uniform in latitude and longitude. A constant environment is not: BSDF
/// sampling finds it as well.
class Environment {
 public:
  explicit Environment(const Scene& scene);

  bool is_sampled() const { return width_ > 0; }

  /// From unit direction w.
  template <class T>
  Vec3<T> radiance(const Vec3<T>& w) const {
    return is_sampled() ? radiance_of<T>(texel_at(w)) : Vec3<T>(constant_);
  }

  /// With which `sample` returns w; 0 where it is not sampled.
  template <class T>
  T pdf(const Vec3<T>& w) const {
    return is_sampled() ? pdf_of(texel_at(w), std::hypot(w.x, w.z)) : T(0);
  }

  /// Only where it is sampled.
  template <class T>
  EnvironmentSample<T> sample(Point2<T> u) const {
    const Interval<T> row = find(&rows_[0], height_, u.y);
    const Interval<T> column = find(columns_of(row.index), width_, u.x);
    const T theta = pi<T> * (static_cast<T>(row.index) + row.fraction) / static_cast<T>(height_);
    const T turn =
        (static_cast<T>(column.index) + column.fraction) / static_cast<T>(width_) - static_cast<T>(turn_);
    const T sine = std::sin(theta), phi = 2 * pi<T> * turn;
    const Texel texel{column.index, row.index};
    return {{sine * std::sin(phi), std::cos(theta), -sine * std::cos(phi)},
            radiance_of<T>(texel),
            pdf_of(texel, sine)};
  }

  /// For kernels; points into this.
  EnvironmentTable table() const;

 private:
  struct Texel {
    int column, row;
  };
  /// Where a number falls among cumulative probabilities.
  template <class T>
  struct Interval {
    int index;
    T fraction;
  };

  template <class T>
  static Interval<T> find(const float* cumulative, int count, T u) {
    const float* const above = std::upper_bound(cumulative + 1, cumulative + count, u);
    const T low = T(above[-1]), high = T(*above);
    return {static_cast<int>(above - cumulative) - 1, (u - low) / (high - low)};
  }

  template <class T>
  Texel texel_at(const Vec3<T>& w) const {
    T turn = std::atan2(w.x, -w.z) / (2 * pi<T>)+static_cast<T>(turn_);
    turn -= std::floor(turn);
    const T down = std::atan2(std::hypot(w.x, w.z), w.y) / pi<T>;
    return {std::min(static_cast<int>(turn * static_cast<T>(width_)), width_ - 1),
            std::min(static_cast<int>(down * static_cast<T>(height_)), height_ - 1)};
  }

  const float* columns_of(int row) const {
    return &columns_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_ + 1)];
  }

  template <class T>
  Vec3<T> radiance_of(const Texel& t) const {
    return Vec3<T>(radiance_[static_cast<std::size_t>(t.row) * static_cast<std::size_t>(width_) +
                             static_cast<std::size_t>(t.column)]);
  }

  template <class T>
  T pdf_of(const Texel& t, T sine) const {
    const float* const columns = columns_of(t.row);
    const T probability =
        (T(rows_[static_cast<std::size_t>(t.row) + 1]) - T(rows_[static_cast<std::size_t>(t.row)])) *
        (T(columns[t.column + 1]) - T(columns[t.column]));
    const T texels_per_angle = static_cast<T>(width_) * static_cast<T>(height_) / (2 * pi<T> * pi<T>);
    return sine > 0 ? probability * texels_per_angle / sine : T(0);
  }

  Vec3d constant_;
  int width_ = 0, height_ = 0;
  double turn_ = 0;  ///< in [0,1): what is added to a direction's longitude to find its column
  std::vector<Vec3f> radiance_;
  std::vector<float> rows_, columns_;  ///< cumulative probabilities, from 0 to 1: of rows, and in each row
};

}  // namespace castray
