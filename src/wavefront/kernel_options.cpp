#include "wavefront/kernel_options.h"

#include <limits>

#include "castray/differences.h"
#include "core/sequences.h"

namespace castray {

namespace {

/// The first samples, whose tiles would be seen: from then on so many grids lie over each other that none can
/// be told. But of what few suffixes meet behind glass single samples are so bright that they show in any
/// sample, as squares where tiles have straight edges.
std::uint64_t ragged_samples(const Plan& plan, bool differences) {
  constexpr std::uint64_t first = 4, all = std::numeric_limits<std::uint64_t>::max();
  if (differences) return first / DifferenceSums::halves;
  return plan.light_paths && plan.suffixes == plan.few_suffixes ? all : first;
}

}  // namespace

bool traces_light_paths(const RenderOptions& options, const Plan& plan) {
  // splats are spread over their pixels, and no sample's part to clamp
  return plan.light_paths && options.jitter && !options.clamp_indirect;
}

KernelOptions kernel_options(const RenderOptions& options, const Plan& plan, bool differences) {
  KernelOptions k{};
  k.sobol = options.sampler == SamplerKind::sobol;
  k.jitter = options.jitter;
  k.fixed_roulette = options.rr.has_value();
  k.survival = static_cast<float>(options.rr.value_or(1.0));
  k.first_roulette = plan.first_roulette;
  k.max_depth = static_cast<std::uint32_t>(options.max_depth);
  k.most_indirect =
      static_cast<float>(options.clamp_indirect.value_or(std::numeric_limits<double>::infinity()));
  k.mis = plan.mis;
  k.light_paths = traces_light_paths(options, plan);
  k.suffixes = plan.suffixes;
  k.branches = plan.branches;
  k.light_points = plan.light_points;
  k.environment_points = plan.environment_points;
  k.ragged = plan.suffixes > 0 ? ragged_samples(plan, differences) : 0;
  k.seed =
      hash_combine(static_cast<std::uint32_t>(options.seed), static_cast<std::uint32_t>(options.seed >> 32));
  return k;
}

}  // namespace castray
