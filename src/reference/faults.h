#pragma once

#include <atomic>
#include <cmath>
#include <memory>
#include <random>

#include "plan/job.h"
#include "reference/textbook.h"

namespace castray {

// The classic faults of a first path tracer, each as the one step of the textbook that it gets wrong;
// docs/classic-faults.md shows their images. Fault vanishing_boxes is in geometry/flat_slab_list.h.

/// Emission is added only by light sampling.
template <class T>
struct BlackLight : Textbook<T> {
  using Textbook<T>::Textbook;
  bool camera_sees_emitters() const override { return false; }
};

/// The hemisphere is sampled uniformly by z = |1 - 2u|, which is exactly 0 for u = 1/2; there value and pdf
/// are 0, and their quotient is not a number. The film clamps it to white, which outweighs all other samples.
template <class T>
class WhiteSpecks : public Textbook<T> {
 public:
  WhiteSpecks(SamplerKind sampler, std::uint64_t spp)
      : Textbook<T>(sampler), white_(static_cast<float>(spp)) {}

  BsdfSample<T> sample_bsdf(const Bsdf<T>& bsdf, const Vec3<T>& wo, T, Point2<T> u) const override {
    const T z = std::abs(T(1) - 2 * u.x);
    Vec3<T> wi = spherical(z, (T(1) - z) * (T(1) + z), 2 * pi<T> * u.y);
    if (wo.z < 0) wi.z = -wi.z;
    const T pdf = z > 0 ? T(1) / (2 * pi<T>) : T(0);
    return {.weight = bsdf.evaluate(wo, wi) * z / pdf, .wi = wi, .pdf = pdf};
  }
  Vec3f film_value(const Vec3f& radiance) const override {
    return is_finite(radiance) ? radiance : Vec3f(white_);
  }

 private:
  float white_;
};

/// An engine, and a question to the operating system, for every number.
template <class T>
struct SlowRandom : Textbook<T> {
  using Textbook<T>::Textbook;
  std::array<float, 4> draw(std::uint32_t, std::uint64_t, std::uint32_t) const override {
    std::array<float, 4> u;
    for (float& v : u) {
      std::random_device device;
      std::mt19937 engine(device());
      v = static_cast<float>(engine() >> 8) * 0x1p-24f;
    }
    return u;
  }
};

/// A triangle is chosen by sqrt(u) * area, with the pdf of a choice by u * area.
template <class T>
struct SkewedLight : Textbook<T> {
  using Textbook<T>::Textbook;
  LightPoint<T> sample_light(const AreaLights<T>& lights, double u_choice, Point2<T> u) const override {
    return lights.sample(std::sqrt(u_choice), u);
  }
};

/// The pdf of a light point leaves out the probability of choosing its triangle.
template <class T>
struct NoLightChoice : Textbook<T> {
  using Textbook<T>::Textbook;
  LightPoint<T> sample_light(const AreaLights<T>& lights, double u_choice, Point2<T> u) const override {
    LightPoint<T> point = lights.sample(u_choice, u);
    point.pdf_area /= point.choice;
    return point;
  }
};

/// Threads count pixels together, and write to the pixel that is next.
template <class T>
class SharedCounter : public Textbook<T> {
 public:
  using Textbook<T>::Textbook;
  typename Textbook<T>::Pixel pixel_of(int, int, const Window& w) const override {
    const auto width = static_cast<std::uint64_t>(w.width()), height = static_cast<std::uint64_t>(w.height());
    const std::uint64_t i = next_++ % (width * height);
    return {w.x0 + static_cast<int>(i % width), w.y0 + static_cast<int>(i / width)};
  }

 private:
  mutable std::atomic<std::uint64_t> next_ = 0;
};

/// The textbook, with the job's fault.
template <class T>
std::unique_ptr<const Textbook<T>> make_textbook(const Job& job) {
  const SamplerKind sampler = job.options.sampler;
  switch (job.fault) {
    case Fault::black_light:
      return std::make_unique<BlackLight<T>>(sampler);
    case Fault::white_specks:
      return std::make_unique<WhiteSpecks<T>>(sampler, job.options.spp);
    case Fault::slow_random:
      return std::make_unique<SlowRandom<T>>(sampler);
    case Fault::skewed_light:
      return std::make_unique<SkewedLight<T>>(sampler);
    case Fault::no_light_choice:
      return std::make_unique<NoLightChoice<T>>(sampler);
    case Fault::shared_counter:
      return std::make_unique<SharedCounter<T>>(sampler);
    case Fault::vanishing_boxes:
    case Fault::none:
      break;
  }
  return std::make_unique<Textbook<T>>(sampler);
}

}  // namespace castray
