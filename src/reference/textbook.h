#pragma once

#include <array>
#include <cstdint>

#include "castray/film.h"
#include "core/sequences.h"
#include "lights/area_lights.h"
#include "materials/bsdf.h"

namespace castray {

/// The steps of a path tracer that beginners get wrong, done right. Each classic fault (faults.h) replaces
/// one.
template <class T>
class Textbook {
 public:
  explicit Textbook(SamplerKind sampler) : sampler_(sampler) {}
  virtual ~Textbook() = default;

  /// Four random numbers in [0,1).
  virtual std::array<float, 4> draw(std::uint32_t key, std::uint64_t sample, std::uint32_t block) const {
    return sample_block(sampler_, key, sample, block);
  }

  /// Whether a camera ray that hits an emitter adds its emission.
  virtual bool camera_sees_emitters() const { return true; }

  virtual LightPoint<T> sample_light(const AreaLights<T>& lights, double u_choice, Point2<T> u) const {
    return lights.sample(u_choice, u);
  }

  virtual BsdfSample<T> sample_bsdf(const Bsdf<T>& bsdf, const Vec3<T>& wo, T u_lobe, Point2<T> u) const {
    return bsdf.sample(wo, u_lobe, u);
  }

  struct Pixel {
    int x, y;
  };
  /// The pixel of the film that gets the next samples taken through pixel (x,y).
  virtual Pixel pixel_of(int x, int y, const Window&) const { return {x, y}; }

  /// The value that the film gets for a sample; one that is not finite is dropped.
  virtual Vec3f film_value(const Vec3f& radiance) const { return radiance; }

 private:
  SamplerKind sampler_;
};

}  // namespace castray
