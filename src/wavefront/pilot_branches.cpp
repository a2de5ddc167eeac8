#include "wavefront/pilot_branches.h"

#include <algorithm>
#include <cmath>

namespace castray {

namespace {

/// Of two branches over one.
double gain_of(const std::vector<TechniqueFigures>& figures, Samples samples) {
  const TechniqueFigures &one = figures[0], &two = figures[1];
  const double both = std::min(one.camera_error, one.error);
  // Where edges divide pixels it falls as N^-1.5, where light points differ as N^-1: counted as in 16
  // samples.
  const double alike = both * std::sqrt(static_cast<double>(samples) / 16);
  const double own = std::max(((one.error - both) + 2 * (two.error - both)) / 2, 0.0);
  // Rays of branches are incoherent: 1.3 times as long as those of the camera and of light samples.
  constexpr double incoherent = 1.3;
  const double branch = std::max(two.cost - one.cost, 0.0), rest = std::max(one.cost - branch, 0.0);
  const double more = incoherent * branch;
  if (!(own > 0) || !(more > 0)) return 1;
  return (alike + own) * (rest + more) / ((alike + own / 2) * (rest + 2 * more));
}

/// The standard error of the logarithm of a gain, by the jackknife over tiles; and a factor of 1.2 in each
/// tile for noise that few of them have met.
double error_of(const TileTrials& trials, double gain) {
  constexpr double unseen = 0.033;  // squared log of 1.2
  const double tiles = static_cast<double>(trials.tiles());
  double variance = unseen / tiles;
  for (std::size_t tile = 0; tile < trials.tiles(); ++tile) {
    const double change = std::log(gain_of(trials.figures_without(tile), trials.samples()) / gain);
    variance += change * change * (tiles - 1) / tiles;
  }
  return std::sqrt(variance);
}

}  // namespace

BranchGain find_branches(const Pilot& pilot, KernelOptions options) {
  constexpr double share = 0.025, few_samples = 16;
  Pilot both = pilot;
  both.matte = true;  // what the two have alike is of interest in all scenes
  options.suffixes = 0;
  options.branches = 1;
  std::vector<KernelOptions> techniques(2, options);
  techniques[1].branches = 2;
  TileTrials trials(both, techniques, Samples::one);
  if (!trials.try_more()) return {};
  const double most = share * few_samples * pilot.width * pilot.height * trials.figures()[0].cost;
  if (trials.cost() + trials.cost_of_group(Samples::four) <= most) {
    const double spent = trials.cost();
    trials = TileTrials(both, techniques, Samples::four);
    while (trials.try_more() && spent + trials.cost() + trials.cost_of_group(Samples::four) <= most) {
    }
  }
  const double gain = gain_of(trials.figures(), trials.samples());
  return {gain, std::exp(error_of(trials, gain))};
}

}  // namespace castray
