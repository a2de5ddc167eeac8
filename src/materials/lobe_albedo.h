#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <map>
#include <vector>

#include "castray/vec.h"
#include "materials/kernel_material.h"

namespace castray {

/// What a lobe of Schlick's Fresnel term and a base under it scatter straight on.
inline Vec3d coated_albedo(const Vec3d& base, const Vec3d& f0) { return f0 + (Vec3d(1) - f0) * base; }

/// Directional albedo of a GGX lobe with Schlick's Fresnel term, as a function of the cosine to the normal.
///
/// Schlick's term is F0 (1 - s) + s with s = (1 - h.wo)^5, so the albedo of any F0 is E(c) = F0 a(c) + b(c).
/// What it leaves is 1 - E(c) = (1 - F0) a(c) + lost(c), with lost = 1 - a - b what facets of F0 = 1 lose to
/// one another: a sum of numbers that are not negative, without the cancellation that 1 - E would have
/// near 1. a and lost are tabulated at c = (i / intervals)^2, finer at grazing angles, and interpolated
/// linearly; the mean 2 * integral of (1 - E(c)) c dc is that of the interpolant itself, so that what is
/// divided by it closes.
class LobeAlbedo {
 public:
  static constexpr int intervals = 128;

  /// Computed in double by quadrature, about 5 ms. `alpha` is GGX's width; 0 is a mirror. Of a lobe that is
  /// not round (Ggx::aspect), a and lost are the least of all azimuths, so that what is left is never too
  /// much; five times as long.
  explicit LobeAlbedo(double alpha, double aspect = 1);

  /// What both leave at least, for any F0.
  LobeAlbedo(const LobeAlbedo& one, const LobeAlbedo& other);

  /// The table between `low` (t = 0) and `high` (t = 1).
  LobeAlbedo(const LobeAlbedo& low, const LobeAlbedo& high, double t);

  /// 1 - E at cosine c in [0,1], for the reflectance F0 at normal incidence.
  template <class T>
  Vec3<T> left(T c, const Vec3<T>& f0) const {
    const T x = std::sqrt(c) * T(intervals);
    const int i = x < T(intervals - 1) ? static_cast<int>(x) : intervals - 1;
    const Node &low = nodes_[static_cast<std::size_t>(i)], &high = nodes_[static_cast<std::size_t>(i) + 1];
    const T c0 = cosine<T>(i), c1 = cosine<T>(i + 1);
    const T t = (c - c0) / (c1 - c0);
    const T a = T(low.a) + t * T(high.a - low.a);
    const T lost = T(low.lost) + t * T(high.lost - low.lost);
    return (Vec3<T>(1) - f0) * a + Vec3<T>(lost);
  }

  /// 2 * integral of (1 - E(c)) c dc over [0,1].
  Vec3d mean_left(const Vec3d& f0) const { return (Vec3d(1) - f0) * mean_.a + Vec3d(mean_.lost); }

  struct Node {
    double a = 0, lost = 0;
  };
  const std::array<Node, intervals + 1>& nodes() const { return nodes_; }
  const Node& mean() const { return mean_; }

  template <class T>
  static constexpr T cosine(int i) {
    const T x = static_cast<T>(i) / T(intervals);
    return x * x;
  }

 private:
  void find_mean();

  std::array<Node, intervals + 1> nodes_;
  Node mean_;
};

/// The tables of a material's lobes; null for lobes that it has not.
struct LobeTables {
  const LobeAlbedo *own = nullptr, *clearcoat = nullptr;
};

/// The albedo of a base of colour kd over what a coat of reflectance f0 leaves for it on the mean. Where that
/// is less than least_left_for_base, all of it at grazing angles, the base gets only part of what is left: a
/// quotient of such small numbers would be bright specks.
inline Vec3d base_under(const Vec3d& kd, const Vec3d& f0, const LobeAlbedo& coat) {
  const Vec3d left = coat.mean_left(f0);
  const auto at_least = [](double x) { return std::max(x, double{least_left_for_base}); };
  return kd / Vec3d(at_least(left.x), at_least(left.y), at_least(left.z));
}

/// What facets reflect more than once (Kulla and Conty 2017, "Revisiting physically based shading"), for a
/// mean Fresnel term F: c (1 - E(cos_i)) (1 - E(cos_o)) / pi, with E the directional albedo of facets that
/// reflect all, F^2 E_mean / (1 - F (1 - E_mean)) over 1 - E_mean for c, returned here. Where that mean is
/// less than least_left_for_base, it is only part of the light.
Vec3d scattered_again(const Vec3d& mean_fresnel, const LobeAlbedo& lobe);

/// Of a lobe: alpha, and Ggx::aspect; or of all lobes from that aspect to a round one.
struct LobeWidths {
  double alpha, aspect = 1;
  bool to_round = false;

  auto operator<=>(const LobeWidths&) const = default;
};

/// Of all lobes of those widths, what they leave at least.
LobeAlbedo least_albedo(const LobeWidths& widths);

/// Tables, each computed once. References stay valid.
class LobeAlbedos {
 public:
  const LobeAlbedo& of(const LobeWidths& widths) {
    const auto found = tables_.find(widths);
    return found != tables_.end() ? found->second
                                  : tables_.emplace(widths, least_albedo(widths)).first->second;
  }

 private:
  std::map<LobeWidths, LobeAlbedo> tables_;
};

/// Tables for what an image of alpha can say: alpha is rounded to (row / steps)^2, as fine in roughness as 8
/// bits are. Every fourth one is computed, the others lie between two: 0.3 s, once for all scenes.
class LobeAlbedoRows {
 public:
  static const LobeAlbedoRows& all();

  static constexpr int steps = 256;
  static constexpr int first = 3;  ///< the least whose alpha is not smooth

  template <class T>
  static int row_of(T alpha) {
    return std::clamp(static_cast<int>(std::sqrt(alpha) * T(steps) + T(0.5)), first, steps);
  }
  static constexpr double alpha_of(int row) { return static_cast<double>(row) * row / (steps * steps); }

  const LobeAlbedo& operator[](int row) const { return rows_[static_cast<std::size_t>(row)]; }
  const std::vector<LobeAlbedo>& rows() const { return rows_; }

 private:
  LobeAlbedoRows();

  std::vector<LobeAlbedo> rows_;
};

}  // namespace castray
