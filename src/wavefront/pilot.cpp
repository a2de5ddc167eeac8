#include "wavefront/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "castray/vec.h"
#include "core/sequences.h"
#include "core/warp.h"
#include "wavefront/pilot_light_paths.h"

namespace castray {

namespace {

/// Sums over splats: radiance, and the second moments of a sample of that light, by light paths and by
/// chance.
struct SplatSums {
  Vec3d radiance, by_light, by_chance;
  double rays = 0;

  void add(const Splats& splats) {
    for (int i = 0; i < splats.count; ++i) {
      const auto at = [i](const float* const(&v)[3]) { return Vec3d(v[0][i], v[1][i], v[2][i]); };
      const Vec3d splat = at(splats.radiance), chance = at(splats.by_chance);
      if (!is_finite(splat) || !is_finite(chance)) continue;
      radiance += splat;
      by_light += splat * splat;
      by_chance += splat * chance;
    }
  }
};

/// Means over the light paths of a pilot; rays, and what light paths make of a sample, of as many as an image
/// has of them.
SplatSums try_light_paths(const Pilot& pilot, KernelOptions options, const LightPathsJob& light_paths_job) {
  options.seed = hash_combine(0x9170fu, 0u);
  std::vector<SplatSums> batches(batches_of(pilot) / 2);
  for_each_batch(pilot, batches.size(), [&](std::size_t i, const LightPathJob& job) {
    const SplatSink sink{
        &batches[i], [](void* self, const Splats& splats) { static_cast<SplatSums*>(self)->add(splats); }};
    batches[i].rays = static_cast<double>(light_paths_job(options, job, sink));
  });
  SplatSums means;  // in the batches' order, whatever the threads
  const double share = 1.0 / static_cast<double>(batches.size() * batch_size);
  for (const SplatSums& batch : batches) {
    means.radiance += batch.radiance * share;
    means.by_light += batch.by_light * share;
    means.by_chance += batch.by_chance * share;
    means.rays += batch.rays * share;
  }
  means.by_light = means.by_light / pilot.light_paths_per_pixel;
  means.rays *= pilot.light_paths_per_pixel;
  return means;
}

/// Plain and shared paths, with caustics by one technique; the same where paths are plain.
struct Ways {
  TechniqueFigures plain, shared;
  bool narrow_coats = false;  ///< as in Pilot
  bool matte = false;         ///< likewise
  double growth = 1;          ///< see growth_beside_plain
  double camera_error = 0;    ///< of plain and of shared paths, besides their own
};

/// Errors times costs; `few`: that of shared paths is with half of the suffixes.
struct Products {
  double plain, shared;
  bool few = false;

  std::optional<double> sharing() const {
    if (!(plain > 0) || !(shared > 0)) return {};
    return plain / shared;
  }
  double least(bool or_plain) const { return or_plain ? std::min(plain, shared) : shared; }
};

/// From a pilot's samples to 64 the error of shared paths grows that many times, beside that of plain ones,
/// which are stratified over all samples of a pixel: by a tenth at least in each step, as on scenes of many
/// kinds; typically by what is taken where single samples are all that is known.
double growth_beside_plain(const Ways& ways) {
  const auto remains = [](const TechniqueFigures& f) { return f.error / f.single_error; };
  constexpr double least = 1.1, most = 1.5, typical = 1.5;
  if (!(ways.plain.error > 0) || !(ways.shared.error > 0)) return 1;
  if (!(ways.plain.single_error > 0)) return typical;
  const double growth = std::clamp(remains(ways.shared) / remains(ways.plain), least, most);
  return growth * growth;  // 4 to 64 are two steps of 1 to 4
}

/// Without what all techniques have alike: it is of pixels' own.
TechniqueFigures without_camera_error(TechniqueFigures f) {
  const double own = std::max(f.own_share * f.error - f.camera_error, 0.0);
  f.error -= f.camera_error;
  f.own_share = f.error > 0 ? std::min(own / f.error, 1.0) : 0;
  return f;
}

/// What all techniques have alike, in 64 samples. Within pixels these are stratified: where an edge divides a
/// pixel the variance falls as N^-1.5 (Mitchell 1996).
double camera_error(const TechniqueFigures& f, Samples samples) {
  return f.camera_error * std::sqrt(static_cast<double>(samples) / 64);
}

/// How much of the noise of shared paths is taken for pixels' own, from 0 to 1: all of it where most is. Rare
/// bright samples that no tile has met are pixels' own, too.
double taken_for_own(double own_share) {
  constexpr double half = 0.5, most_own = 0.65;
  return std::clamp((own_share - half) / (most_own - half), 0.0, 1.0);
}

/// Bright samples in single pixels of a tile that shares its paths came by paths of these pixels alone, which
/// plain paths find as rarely: an error of both. The more samples, the brighter ones are met, so it counts
/// several times. Not where neighbours' noise is alike: there shared paths are as bright themselves. In matte
/// scenes pixels have no paths of their own.
double common_error(const TechniqueFigures& shared) {
  constexpr double missed = 3;
  return missed * shared.lonely_error * taken_for_own(shared.own_share);
}

/// The least that is taken for common to both: a lamp in a narrow lobe over a base is found by chance, as
/// bright as in a mirror and rarer than pilots meet. It is little beside the noise of rooms, and much where
/// plain paths have hardly any: in the sun.
double unseen_error(const Ways& ways) {
  constexpr double by_narrow_coats = 0.05;  // in sunlight on plastic of several roughnesses 0.02 to 0.1
  return ways.narrow_coats ? by_narrow_coats : 0;
}

/// Where neighbours' noise is alike, sharing has spread what plain paths find as rare bright samples. These
/// may all be in the few tiles whose errors are lowered.
double plain_error(const Ways& ways) {
  const bool spread = taken_for_own(ways.shared.own_share) == 0;
  return spread ? std::max(ways.plain.error, ways.plain.lonely_error) : ways.plain.error;
}

/// How much of the variance by chance is left where paths are shared, if the tiles find caustics as often as
/// light paths say. `expected`: that variance. The rarest of what is left is missed by few tiles: it counts
/// twice.
double left_by_sharing(const Ways& by_light, const Ways& by_chance, double expected) {
  constexpr double often_enough = 0.5, missed = 2;
  const double alone = by_chance.plain.error - by_light.plain.error;
  if (!(alone > often_enough * expected)) return 1;
  const double shared = by_chance.shared.error - by_light.shared.error;
  return std::clamp(missed * shared / alone, 1.0 / tile_pixels, 1.0);
}

/// Mean second moments of caustics, relative as relMSE is. `rest`: the brightness of all else.
struct CausticErrors {
  double by_light = 0, by_chance = 0;

  CausticErrors(const SplatSums& splats, const Vec3d& rest) {
    for (int c = 0; c < 3; ++c) {
      const double brightness = rest[c] + splats.radiance[c];
      by_light += splats.by_light[c] / (brightness * brightness + 0.01);
      by_chance += splats.by_chance[c] / (brightness * brightness + 0.01);
    }
  }
};

/// With the error of caustics, by plain and by shared paths, and the cost of light paths, besides those of
/// `rest`.
///
/// Half of the suffixes make the error beside that of caustics half as large again, and the cost, of which
/// that share of plain paths' is left without any, is linear in their number: both within a fifth, as on
/// scenes with mirrors and glass. They are taken where that is more efficient, unless all of them gain much:
/// there caustics are less of the error of many samples than of few.
Products products_of(const Ways& ways, const Ways& rest, double of_plain, double of_shared, double rays,
                     bool few_may_do) {
  constexpr double error_of_half = 1.55, cost_of_none = 0.63, gains_much = 2.25;
  const double plain_cost = ways.plain.cost + rays, cost = ways.shared.cost + rays;
  const double error = rest.shared.error * rest.growth;
  const double by_own_paths = rest.matte ? 0 : std::max(common_error(rest.shared), unseen_error(rest));
  const double common = by_own_paths + rest.camera_error;
  const double plain = (plain_error(rest) + of_plain + common) * plain_cost;
  const double all = (error + of_shared + common) * cost;
  const double half = (error_of_half * error + of_shared + common) * (cost_of_none * plain_cost + cost) / 2;
  const bool few = few_may_do && half < all && plain < gains_much * all;
  return {plain, few ? half : all, few};
}

/// The efficiency of reconstruction over means, with shared paths to which pixels' own noise and rays are
/// added.
///
/// Of what neighbours have alike 0.3 is left, as in scenes of many kinds. Rare bright samples that no tile
/// has met are a pixel's own; so the more of the error is known to be, from half of it on, the less is
/// counted on, and nothing from 0.65 on. Time is that at 4 samples, where it counts most, in rays: of sums
/// for each sample, and of edges and equations once for each pixel.
double gain_of_reconstruction(const TechniqueFigures& shared, double splats, double rays, bool list) {
  constexpr double least_left = 0.3, few_samples = 4;
  const double unit = list ? 1 : 0.25, sums = 1 * unit, equations = 13 * unit;
  const double own_error = splats + common_error(shared);
  if (!(shared.error + own_error > 0)) return 0;
  const double own = (shared.own_share * shared.error + own_error) / (shared.error + own_error);
  const double left = least_left + (1 - least_left) * taken_for_own(own);
  const double error = std::min(own, 1.0) * (1 - left) + left, cost = shared.cost + rays;
  return cost / (cost + sums + equations / few_samples) / error;
}

/// Plain and, where options share, shared paths; then, if `both`, the same with caustics by chance.
std::vector<KernelOptions> techniques_of(const KernelOptions& options, bool both) {
  KernelOptions plain = options;
  plain.suffixes = 0;
  std::vector<KernelOptions> techniques{plain};
  if (options.suffixes > 0) techniques.push_back(options);
  for (std::size_t k = 0, ways = techniques.size(); both && k < ways; ++k) {
    techniques.push_back(techniques[k]);
    techniques.back().light_paths = false;
  }
  return techniques;
}

/// What gains are computed from, but for the figures of tiles.
struct Question {
  OpenChoices open;
  bool by_lights;                  ///< caustics may be brought by light paths
  bool both;                       ///< it is open whether they are
  bool tried;                      ///< then tiles were tried with caustics by chance, too
  bool list, narrow_coats, matte;  ///< as in Pilot
  std::size_t ways;                ///< 2: shared and plain paths; 1: plain ones
  Samples samples;                 ///< of the tiles' figures
  SplatSums splats;
};

Ways ways_of(const Question& q, const TechniqueFigures& plain, const TechniqueFigures& shared) {
  Ways ways{plain, shared, q.narrow_coats, q.matte};
  ways.growth = growth_beside_plain(ways);
  ways.camera_error = camera_error(shared, q.samples);
  ways.plain = without_camera_error(plain);
  ways.shared = without_camera_error(shared);
  return ways;
}

/// `figures`: of techniques_of.
Gains gains_of(const Question& q, const std::vector<TechniqueFigures>& figures) {
  const TechniqueFigures& shared = figures[q.ways - 1];
  const Ways rest = ways_of(q, figures[0], shared);
  Gains gains;
  if (!q.by_lights) {
    const Products by_chance = products_of(rest, rest, 0, 0, 0, q.open.few);
    gains.sharing_by_chance = by_chance.sharing();
    gains.few_by_chance = by_chance.few;
    gains.reconstruction_by_chance = gain_of_reconstruction(shared, 0, 0, q.list);
    return gains;
  }
  const double rays = q.splats.rays;
  const CausticErrors caustics(q.splats, rest.plain.brightness);
  const Products by_light = products_of(rest, rest, caustics.by_light, caustics.by_light, rays, q.open.few);
  gains.sharing_by_lights = by_light.sharing();
  gains.few_by_lights = by_light.few;
  gains.reconstruction_by_lights = gain_of_reconstruction(shared, caustics.by_light, rays, q.list);
  const double fewer = caustics.by_light / 2;
  const Products twice = products_of(rest, rest, fewer, fewer, 2 * rays, q.open.few);
  if (twice.plain > 0) gains.twice_with_plain = by_light.plain / twice.plain;
  if (twice.shared > 0) gains.twice_with_shared = by_light.shared / twice.shared;
  if (!q.both || !(max_component(q.splats.radiance) > 0)) return gains;
  const Ways chance = q.tried ? ways_of(q, figures[q.ways], figures.back()) : rest;
  const double left = q.tried ? left_by_sharing(rest, chance, caustics.by_chance) : 1;
  const Products by_chance =
      products_of(chance, rest, caustics.by_chance, caustics.by_chance * left, 0, q.open.few);
  gains.sharing_by_chance = by_chance.sharing();
  gains.few_by_chance = by_chance.few;
  gains.reconstruction_by_chance = gain_of_reconstruction(shared, caustics.by_chance * left, 0, q.list);
  gains.light_paths = by_chance.least(q.open.sharing) / by_light.least(q.open.sharing);
  return gains;
}

/// Whether light paths do better than chance even if sharing leaves as little of that as it can.
bool light_paths_win(const Question& q, const std::vector<TechniqueFigures>& figures) {
  const Ways rest = ways_of(q, figures[0], figures[q.ways - 1]);
  const CausticErrors caustics(q.splats, rest.plain.brightness);
  const double least = caustics.by_chance / tile_pixels;
  const Products by_light =
      products_of(rest, rest, caustics.by_light, caustics.by_light, q.splats.rays, q.open.few);
  const Products by_chance = products_of(rest, rest, caustics.by_chance, least, 0, q.open.few);
  return by_light.least(q.open.sharing) < by_chance.least(q.open.sharing);
}

/// Logarithms of the gains of what is open: of light paths, and with caustics as these are chosen, of sharing
/// and of reconstruction.
enum Choice { of_light_paths, of_sharing, of_reconstruction, choices };
using LogGains = std::array<std::optional<double>, choices>;
using LogErrors = std::array<double, choices>;

LogGains log_gains(const Question& q, const std::vector<TechniqueFigures>& figures) {
  const Gains g = gains_of(q, figures);
  const bool lights = q.by_lights && g.light_paths.value_or(1) >= 1;
  LogGains log{g.light_paths, lights ? g.sharing_by_lights : g.sharing_by_chance,
               lights ? g.reconstruction_by_lights : g.reconstruction_by_chance};
  if (!q.open.sharing) log[of_sharing].reset();
  if (!q.open.reconstruction || log[of_sharing].value_or(1) < 1) log[of_reconstruction].reset();
  for (std::optional<double>& gain : log) {
    if (gain && !(*gain > 0)) gain.reset();
    if (gain) *gain = std::log(*gain);
  }
  return log;
}

/// The standard error of each logarithm of `gains`, by the jackknife over tiles. Of noise that few tiles have
/// met it tells nothing, so a factor of 1.6 in each tile is added, 2 where there is one sample of each; its
/// square for reconstruction, which hardly helps against such noise. Single samples do not tell how errors
/// fall, either: a factor of 1.2 for all tiles together.
LogErrors errors_of(const Question& q, const TileTrials& trials, const LogGains& gains) {
  constexpr double of_four = 0.25, of_one = 0.5, of_fall = 0.04;  // squared logs of those factors
  const bool one = trials.samples() == Samples::one;
  const double tiles = static_cast<double>(trials.tiles());
  const double unseen = (one ? of_one : of_four) / tiles, fall = one ? of_fall : 0;
  LogErrors variance{unseen, unseen + fall, 4 * unseen};
  for (std::size_t tile = 0; tile < trials.tiles(); ++tile) {
    const LogGains without = log_gains(q, trials.figures_without(tile));
    for (std::size_t k = 0; k < gains.size(); ++k) {
      const double change = without[k].value_or(0) - gains[k].value_or(0);
      variance[k] += change * change * (tiles - 1) / tiles;
    }
  }
  for (double& v : variance) v = std::sqrt(v);
  return variance;
}

/// By how much a choice by `log_gain` is expected to fall short of the better one, if its error is normal.
double expected_loss(double log_gain, double error) {
  const double z = std::abs(log_gain) / error;
  const double density = std::exp(-z * z / 2) / std::sqrt(2 * pi<double>),
               beyond = std::erfc(z / std::sqrt(2.0)) / 2;
  return error * (density - z * beyond);
}

/// Of an image of few samples, by plain paths; in rays.
double cost_of_few_samples(const Pilot& pilot, const Question& q, const TileTrials& trials) {
  constexpr double few_samples = 16;
  const double rays = q.by_lights ? q.splats.rays : 0;
  return few_samples * pilot.width * pilot.height * (trials.figures().front().cost + rays);
}

/// Whether all that is open can be chosen, with a loss of efficiency that more of a pilot would not make up
/// for.
bool is_clear(const Question& q, const TileTrials& trials, double worthwhile) {
  const LogGains gains = log_gains(q, trials.figures());
  const LogErrors errors = errors_of(q, trials, gains);
  if (gains[of_reconstruction] && trials.samples() == Samples::one) return false;  // it is of means
  for (std::size_t k = 0; k < gains.size(); ++k)
    if (gains[k] && expected_loss(*gains[k], errors[k]) > worthwhile) return false;
  return true;
}

/// Whether paths will be shared, and gain so much that a longer pilot cannot make them worse than plain ones;
/// or are so as it is wanted.
bool surely_shares(const Question& q, const TileTrials& trials) {
  constexpr double much = 2, errors_beyond = 1;
  if (!q.open.sharing) return q.open.reconstruction;
  const LogGains gains = log_gains(q, trials.figures());
  if (!gains[of_sharing]) return false;
  return *gains[of_sharing] > std::log(much) + errors_beyond * errors_of(q, trials, gains)[of_sharing];
}

}  // namespace

Gains find_gains(const Pilot& pilot, const KernelOptions& options, const OpenChoices& open,
                 const LightPathsJob& light_paths_job) {
  constexpr double share = 0.035;  // of an image of few samples, for the pilot
  const bool both = options.light_paths && open.caustics;
  TileTrials trials(pilot, techniques_of(options, false), Samples::one);
  if (!trials.try_more()) return {};
  const std::size_t ways = options.suffixes > 0 ? 2 : 1;
  Question q{.open = open,
             .by_lights = options.light_paths,
             .both = both,
             .tried = false,
             .list = pilot.list,
             .narrow_coats = pilot.narrow_coats,
             .matte = pilot.matte,
             .ways = ways,
             .samples = trials.samples(),
             .splats = {}};
  if (options.light_paths) q.splats = try_light_paths(pilot, options, light_paths_job);
  const double image = cost_of_few_samples(pilot, q, trials);
  double left = share * image - trials.cost();
  const bool chance_may_win = both && !light_paths_win(q, trials.figures());
  while (true) {
    const bool more_ways = chance_may_win && !q.tried;  // as many again, and only with four samples
    const double longer = trials.cost_of_group(Samples::four) * (more_ways ? 2 : 1);
    const bool limited = !surely_shares(q, trials), four = !limited || longer <= left;
    const double next = four ? longer : trials.cost_of_group(trials.samples());
    if ((limited && next > left) || (!(four && more_ways) && is_clear(q, trials, next / image))) break;
    if (four && trials.samples() == Samples::one) {
      q.tried = chance_may_win;
      q.samples = Samples::four;
      trials = TileTrials(pilot, techniques_of(options, q.tried), q.samples);
    }
    if (!trials.try_more()) break;
    left -= next;
  }
  Gains gains = gains_of(q, trials.figures());
  gains.sharing_error = std::exp(errors_of(q, trials, log_gains(q, trials.figures()))[of_sharing]);
  gains.by_single_samples = trials.samples() == Samples::one;
  return gains;
}

}  // namespace castray
