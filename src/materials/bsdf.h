#pragma once

#include "materials/material_list.h"

namespace castray {

/// How a material reflects, at a point; see bsdf_sample.h for the contract.
template <class T>
class Bsdf {
 public:
  template <class Model>
  Bsdf(const Model& model) : model_(model) {}

  Vec3<T> evaluate(const Vec3<T>& wo, const Vec3<T>& wi) const {
    return std::visit([&](const auto& m) { return m.evaluate(wo, wi); }, model_);
  }
  T pdf(const Vec3<T>& wo, const Vec3<T>& wi) const {
    return std::visit([&](const auto& m) { return m.pdf(wo, wi); }, model_);
  }
  BsdfSample<T> sample(const Vec3<T>& wo, T u_lobe, Point2<T> u) const {
    return std::visit([&](const auto& m) { return m.sample(wo, u_lobe, u); }, model_);
  }

 private:
  AnyBsdf<T> model_;
};

}  // namespace castray
