#pragma once

#include <array>
#include <cmath>
#include <map>

#include "castray/vec.h"

namespace castray {

/// Directional albedo of a GGX lobe with Schlick's Fresnel term, as a function of the cosine to the normal.
///
/// Schlick's term is F0 (1 - s) + s with s = (1 - h.wo)^5, so the albedo of any F0 is E(c) = F0 a(c) + b(c).
/// a and b are tabulated at c = (i / intervals)^2, finer at grazing angles, and interpolated linearly; the
/// mean 2 * integral of E(c) c dc is that of the interpolant itself, so that what is divided by it closes.
class LobeAlbedo {
 public:
  static constexpr int intervals = 128;

  /// Computed in double by quadrature, about 5 ms. `alpha` is GGX's width; 0 is a mirror.
  explicit LobeAlbedo(double alpha);

  /// E at cosine c in [0,1], for the reflectance F0 at normal incidence.
  template <class T>
  Vec3<T> at(T c, const Vec3<T>& f0) const {
    const T x = std::sqrt(c) * T(intervals);
    const int i = x < T(intervals - 1) ? static_cast<int>(x) : intervals - 1;
    const Node &low = nodes_[static_cast<std::size_t>(i)], &high = nodes_[static_cast<std::size_t>(i) + 1];
    const T c0 = cosine<T>(i), c1 = cosine<T>(i + 1);
    const T t = (c - c0) / (c1 - c0);
    const T a = T(low.a) + t * T(high.a - low.a);
    const T b = T(low.b) + t * T(high.b - low.b);
    return f0 * a + Vec3<T>(b);
  }

  /// 2 * integral of E(c) c dc over [0,1].
  Vec3d mean(const Vec3d& f0) const { return f0 * mean_.a + Vec3d(mean_.b); }

  struct Node {
    double a = 0, b = 0;
  };
  const std::array<Node, intervals + 1>& nodes() const { return nodes_; }

  template <class T>
  static constexpr T cosine(int i) {
    const T x = static_cast<T>(i) / T(intervals);
    return x * x;
  }

 private:
  std::array<Node, intervals + 1> nodes_;
  Node mean_;
};

/// Tables by alpha, each computed once. References stay valid.
class LobeAlbedos {
 public:
  const LobeAlbedo& of(double alpha) { return tables_.try_emplace(alpha, alpha).first->second; }

 private:
  std::map<double, LobeAlbedo> tables_;
};

}  // namespace castray
