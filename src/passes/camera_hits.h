#pragma once

#include <cstdint>
#include <vector>

#include "castray/film.h"
#include "castray/render_options.h"
#include "castray/scene.h"
#include "geometry/scene_bvh.h"
#include "materials/coverage.h"
#include "reference/segments.h"
#include "reference/surface.h"

namespace castray {

/// What a surface looks like, whatever light falls on it.
struct Appearance {
  Vec3f albedo, normal;  ///< black and zero where nothing is seen
};

/// The surface that a camera's ray meets first.
struct FirstHit {
  std::uint32_t triangle = Scene::no_index;
  Appearance appearance;
  Vec3d position;             ///< in the world
  double depth = 0;           ///< in the world, along the view direction; of a panorama along the ray
  Appearance behind_mirrors;  ///< where it was asked for

  bool found() const { return triangle != Scene::no_index; }
};

/// Finds what camera samples see. The scene must outlive it.
class CameraHits {
 public:
  /// `behind_mirrors`: whether mirrors and smooth glass are followed, too.
  CameraHits(const Scene& scene, const RenderOptions& options, const Window& window, int threads,
             bool behind_mirrors);

  /// Of sample `sample` of pixel (x,y) of the full image: castRay's camera ray. Called by several threads.
  FirstHit at(int x, int y, std::uint64_t sample) const;

 private:
  /// Where a path is on its way through mirrors.
  struct Path {
    std::uint32_t key;
    std::uint64_t sample;
    std::uint32_t world;
  };
  Hit<float> closest(const Ray<float>& ray, const Path& path) const;
  Vec3f albedo(const Surface<float>& x, const Hit<float>& hit) const;
  Appearance appearance(const Surface<float>& x, const Hit<float>& hit) const;
  Appearance behind_mirrors(Surface<float> x, Hit<float> hit, const Path& path) const;

  const Scene& scene_;
  RenderOptions options_;
  int width_, height_;
  bool follows_;
  SceneBvh bvh_;
  Surfaces<float> surfaces_;
  Coverage coverage_;
  Segments<float> segments_;
  std::vector<Vec3f> albedos_;  ///< of each material, where no image changes it
};

}  // namespace castray
