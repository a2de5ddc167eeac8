#pragma once

#include <string_view>
#include <utility>

#include "castray/render_options.h"
#include "plan/fault.h"

namespace castray {

/// A choice as flags, scene files and film keys call it.
template <class T>
using OptionName = std::pair<std::string_view, T>;

inline constexpr OptionName<SamplerKind> sampler_names[] = {{"sobol", SamplerKind::sobol},
                                                            {"independent", SamplerKind::independent}};
inline constexpr OptionName<Precision> precision_names[] = {{"float", Precision::float32},
                                                            {"double", Precision::float64}};
inline constexpr OptionName<LightSampling> light_sampling_names[] = {
    {"auto", LightSampling::automatic},
    {"area", LightSampling::area},
    {"solid-angle", LightSampling::solid_angle},
    {"tree", LightSampling::tree}};
inline constexpr OptionName<Switch> switch_names[] = {
    {"auto", Switch::automatic}, {"on", Switch::on}, {"off", Switch::off}};
inline constexpr OptionName<Fault> fault_names[] = {{"none", Fault::none},
                                                    {"black-light", Fault::black_light},
                                                    {"vanishing-boxes", Fault::vanishing_boxes},
                                                    {"white-specks", Fault::white_specks},
                                                    {"slow-random", Fault::slow_random},
                                                    {"skewed-light", Fault::skewed_light},
                                                    {"no-light-choice", Fault::no_light_choice},
                                                    {"shared-counter", Fault::shared_counter}};

/// The name of `value`, which is one of `names`.
template <class T, std::size_t N>
constexpr std::string_view name_in(const OptionName<T> (&names)[N], T value) {
  for (const auto& [name, named] : names)
    if (named == value) return name;
  return {};
}

}  // namespace castray
