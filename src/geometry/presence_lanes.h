#pragma once

#include "core/contract.h"
#include "geometry/geometry_records.h"
#include "geometry/ray_batches.h"
#include "simd/random_lanes.h"

// Which of the hits that a traversal finds count. It asks by `counts(ray, triangle, b1, b2)`. `from(i)` is
// the same for the rays from number i on, `in(instance)` that for the triangles of an instance.

namespace castray::CASTRAY_ISA {

/// All of them.
struct AllThere {
  CASTRAY_INLINE AllThere from(uint32_t /*ray*/) const { return *this; }
  CASTRAY_INLINE AllThere in(uint32_t /*instance*/) const { return *this; }
  CASTRAY_INLINE bool operator()(uint32_t /*ray*/, uint32_t /*triangle*/, float /*b1*/, float /*b2*/) const {
    return true;
  }
};

CASTRAY_INLINE bool is_partial(const PartialTriangles& partial, uint32_t triangle) {
  return partial.triangles[triangle / 32] >> (triangle % 32) & 1;
}

/// What of a partial triangle is there around a point.
CASTRAY_INLINE uint32_t coverage_cell(const PartialTriangles& partial, uint32_t triangle, float b1,
                                      float b2) {
  const uint32_t side = partial.grid_side;
  if (side == 0 || partial.grids[triangle] == no_coverage_grid) return cell_mixed;
  const auto place = [side](float b) {
    const auto at = (uint32_t)(b * (float)side);
    return at < side ? at : side - 1;
  };
  const uint32_t column = place(b1), row = place(b2);
  if (column + row >= side) return cell_mixed;  // by rounding
  const uint32_t i = row * side + column;
  return partial.cells[partial.grids[triangle] + i / 16] >> (2 * (i % 16)) & 3;
}

/// Directions of the rays of a batch.
struct RayDirections {
  const float *x, *y, *z;
  template <class Batch>
  CASTRAY_INLINE static RayDirections of(const Batch& rays) {
    return {rays.dx, rays.dy, rays.dz};
  }
  CASTRAY_INLINE RayDirections from(uint32_t ray) const { return {x + ray, y + ray, z + ray}; }
};

/// What a ray may meet of partial triangles.
struct PartialHits {
  const PartialTriangles& partial;
  RayDirections directions;
  uint32_t instance = no_hit;

  CASTRAY_INLINE PartialHits from(uint32_t ray) const { return {partial, directions.from(ray), instance}; }
  CASTRAY_INLINE PartialHits in(uint32_t at) const { return {partial, directions, at}; }

  CASTRAY_INLINE PartialHit at(uint32_t ray, uint32_t triangle, float b1, float b2) const {
    const RayDirections& d = directions;
    return {triangle, instance, b1, b2, {d.x[ray], d.y[ray], d.z[ray]}};
  }

  /// 1 where the triangle is not partial.
  CASTRAY_INLINE float coverage(uint32_t ray, uint32_t triangle, float b1, float b2) const {
    if (!is_partial(partial, triangle)) return 1;
    const uint32_t cell = coverage_cell(partial, triangle, b1, b2);
    if (cell != cell_mixed) return cell == cell_there ? 1.f : 0.f;
    return partial.coverage(partial.self, at(ray, triangle, b1, b2));
  }
};

/// What of the triangles is there in a world.
struct PartlyThere {
  const PartialTriangles& partial;
  uint32_t world;

  /// Whether shadow rays tell what partial triangles leave of their light (ShadowBatch::kept).
  CASTRAY_INLINE bool thins() const { return partial.triangles && partial.met_once; }
};

/// Hits on that.
struct ThereInWorld {
  PartialHits hits;
  uint32_t world;

  CASTRAY_INLINE ThereInWorld from(uint32_t ray) const { return {hits.from(ray), world}; }
  CASTRAY_INLINE ThereInWorld in(uint32_t instance) const {
    return {hits.in(instance), hash_combine(world, instance)};
  }
  CASTRAY_INLINE bool operator()(uint32_t ray, uint32_t triangle, float b1, float b2) const {
    const float coverage = hits.coverage(ray, triangle, b1, b2);
    return coverage >= 1 || (coverage > 0 && presence_number(world, triangle, b1, b2) < coverage);
  }
};

/// The same, but for each ray by a number of its own sequence. So over the samples of a pixel a triangle is
/// there as often as it should be, almost exactly. Different triangles, and the path beyond, have independent
/// numbers.
struct ThereForRays {
  PartialHits hits;
  PresenceNumbers numbers;
  uint32_t block = 0x9e5e4ceu;

  CASTRAY_INLINE ThereForRays from(uint32_t ray) const {
    return {hits.from(ray), {numbers.key + ray, numbers.index + ray, numbers.sobol}, block};
  }
  CASTRAY_INLINE ThereForRays in(uint32_t instance) const {
    return {hits.in(instance), numbers, hash_combine(block, instance)};
  }
  CASTRAY_INLINE bool operator()(uint32_t ray, uint32_t triangle, float b1, float b2) const {
    const float coverage = hits.coverage(ray, triangle, b1, b2);
    return coverage >= 1 || (coverage > 0 && number(ray, triangle) < coverage);
  }

 private:
  CASTRAY_INLINE float number(uint32_t ray, uint32_t triangle) const {
    const Uint key(hash_combine(numbers.key[ray], block));
    return lane(draw<1>(numbers.sobol, {key, Uint(numbers.index[ray])}, triangle).u[0], 0);
  }
};

/// Those where nothing is left of a ray's light. `kept` starts as 1, and loses at each crossing the share
/// that is there.
struct Thinning {
  PartialHits hits;
  float* kept;

  CASTRAY_INLINE Thinning from(uint32_t ray) const { return {hits.from(ray), kept + ray}; }
  CASTRAY_INLINE Thinning in(uint32_t instance) const { return {hits.in(instance), kept}; }
  CASTRAY_INLINE bool operator()(uint32_t ray, uint32_t triangle, float b1, float b2) const {
    kept[ray] *= 1 - hits.coverage(ray, triangle, b1, b2);
    return !(kept[ray] > 0);
  }
};

/// None; but rays lose colours at those which they pass, but for those on which they end.
struct Tinting {
  PartialHits hits;
  float *red, *green, *blue;
  const uint32_t *end, *end_instance;

  CASTRAY_INLINE static Tinting of(const PartialTriangles& partial, const TintBatch& rays) {
    return {{partial, RayDirections::of(rays)}, rays.red, rays.green, rays.blue, rays.end, rays.end_instance};
  }
  CASTRAY_INLINE Tinting from(uint32_t ray) const {
    return {hits.from(ray),        red + ray,
            green + ray,           blue + ray,
            end ? end + ray : end, end_instance ? end_instance + ray : end_instance};
  }
  CASTRAY_INLINE Tinting in(uint32_t instance) const {
    return {hits.in(instance), red, green, blue, end, end_instance};
  }
  CASTRAY_INLINE bool operator()(uint32_t ray, uint32_t triangle, float b1, float b2) const {
    if (is_partial(hits.partial, triangle) && !is_end(ray, triangle))
      hits.partial.tint(hits.partial.self, hits.at(ray, triangle, b1, b2), red + ray, green + ray,
                        blue + ray);
    return false;
  }

 private:
  CASTRAY_INLINE bool is_end(uint32_t ray, uint32_t triangle) const {
    return end && end[ray] == triangle && (hits.instance == no_hit || end_instance[ray] == hits.instance);
  }
};

/// As shadow rays.
CASTRAY_INLINE ShadowBatch segments_of(const TintBatch& r) {
  return {r.ox, r.oy, r.oz, r.dx, r.dy, r.dz, r.t_max, r.room, r.count};
}

/// That of rays which have met nothing.
CASTRAY_INLINE Thinning begin_thinning(const PartialTriangles& partial, const ShadowBatch& rays) {
  for (uint32_t i = 0; i < rays.count; ++i) rays.kept[i] = 1;
  return {{partial, RayDirections::of(rays)}, rays.kept};
}

}  // namespace castray::CASTRAY_ISA
