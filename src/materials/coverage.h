#pragma once

#include <cstdint>
#include <vector>

#include "castray/scene.h"
#include "geometry/ray.h"

namespace castray {

/// What of a scene's surfaces is there, where their materials cover only a share of them
/// (Material::coverage): stochastic transparency (Enderton, Sintorn, Shirley, Luebke 2010). Each point of a
/// triangle is there in some worlds and not in others, with the probability of its coverage there; different
/// points independently of each other. What a ray meets first is then a function of the ray and the world,
/// whatever the order of its tests. As no path meets a point twice, the mean over worlds is light that is
/// thinned by 1 - coverage at each crossing.
///
/// The share of a window that is there is what of the light does not go straight on (Material::is_window), of
/// the colour that passes best; `tint` dims the others. Both depend on the angle between the ray and the
/// normal: that of the vertices where there are such, without the bends of normal and bump maps.
class Coverage {
 public:
  /// The scene must outlive this.
  explicit Coverage(const Scene& scene);

  /// A bit for each triangle, the lowest first: whether its coverage may be below 1. Null: no triangle's.
  const std::uint32_t* partial_triangles() const { return partial_.empty() ? nullptr : partial_.data(); }

  bool is_partial(std::uint32_t triangle) const {
    return !partial_.empty() && (partial_[triangle / 32] >> (triangle % 32) & 1u);
  }

  /// The share of the surface that is there, where a ray of this direction, of any length, meets it.
  template <class T>
  T share_there(const Hit<T>& hit, const Vec3<T>& direction) const;

  /// Whether some material dims colours that pass.
  bool tints() const { return tints_; }

  /// What is left of each colour where a ray of this direction passes the surface, over what is of the one
  /// that passes best.
  template <class T>
  Vec3<T> tint(const Hit<T>& hit, const Vec3<T>& direction) const;

  /// Which hits of a ray count in a path's world, where each instance has a world of its own. The filter must
  /// not outlive this.
  template <class T>
  HitFilter<T> there_in(std::uint32_t world, const Vec3<T>& direction) const;

 private:
  const Scene& scene_;
  std::vector<std::uint32_t> partial_;
  bool tints_;
};

}  // namespace castray
