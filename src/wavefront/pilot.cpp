#include "wavefront/pilot.h"

#include <algorithm>
#include <vector>

#include "castray/vec.h"
#include "core/sequences.h"

namespace castray {

namespace {

/// Sums over splats: radiance, and the second moments of a sample of that light, by light paths, one for each
/// pixel, and by chance.
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

constexpr std::size_t pilot_batches = 64;

/// Means over the light paths of a pilot.
SplatSums try_light_paths(const Pilot& pilot, KernelOptions options, const LightPathsJob& light_paths_job) {
  options.seed = hash_combine(0x9170fu, 0u);
  std::vector<SplatSums> batches(pilot_batches);
#pragma omp parallel for schedule(dynamic) num_threads(pilot.threads)
  for (std::size_t i = 0; i < pilot_batches; ++i) {
    const SplatSink sink{
        &batches[i], [](void* self, const Splats& splats) { static_cast<SplatSums*>(self)->add(splats); }};
    const LightPathJob job{0, i * batch_size, batch_size, pilot.width, pilot.height};
    batches[i].rays = static_cast<double>(light_paths_job(options, job, sink));
  }
  SplatSums means;  // in the batches' order, whatever the threads
  constexpr double share = 1.0 / double(pilot_batches * batch_size);
  for (const SplatSums& batch : batches) {
    means.radiance += batch.radiance * share;
    means.by_light += batch.by_light * share;
    means.by_chance += batch.by_chance * share;
    means.rays += batch.rays * share;
  }
  return means;
}

/// Plain and shared paths, with caustics by one technique; the same where paths are plain.
struct Ways {
  TechniqueFigures plain, shared;
};

/// Errors times costs.
struct Products {
  double plain, shared;

  std::optional<double> sharing() const {
    if (!(plain > 0) || !(shared > 0)) return {};
    return plain / shared;
  }
  double least(bool or_plain) const { return or_plain ? std::min(plain, shared) : shared; }
};

/// From a pilot's samples to 64 the error of shared paths grows that many times, beside that of plain ones,
/// which are stratified over all samples of a pixel. It is not taken to fall.
double growth_beside_plain(const Ways& ways) {
  const auto remains = [](const TechniqueFigures& f) { return f.error / f.single_error; };
  if (!(ways.plain.error > 0) || !(ways.shared.error > 0)) return 1;
  const double growth = std::clamp(remains(ways.shared) / remains(ways.plain), 1.0, 1.5);
  return growth * growth;  // 4 to 64 are two steps of 1 to 4
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
Products products_of(const Ways& ways, const Ways& rest, double of_plain, double of_shared, double rays) {
  return {(rest.plain.error + of_plain) * (ways.plain.cost + rays),
          (rest.shared.error * growth_beside_plain(rest) + of_shared) * (ways.shared.cost + rays)};
}

/// The efficiency of reconstruction over means, with shared paths to which pixels' own noise and rays are
/// added.
///
/// Of what neighbours have alike 0.3 is left, as in scenes of many kinds. Rare bright samples that no tile
/// has met are a pixel's own; so where more than 0.57 of the error is known to be, no gain is counted on.
/// Time is that at 4 samples, where it counts most, in rays: of sums for each sample, and of edges and
/// equations once for each pixel.
double gain_of_reconstruction(const TechniqueFigures& shared, double own_error, double rays, bool list) {
  constexpr double left = 0.3, most_own = 0.57, few_samples = 4;
  const double unit = list ? 1 : 0.25, sums = 1 * unit, equations = 13 * unit;
  if (!(shared.error + own_error > 0)) return 0;
  const double own = (shared.own_share * shared.error + own_error) / (shared.error + own_error);
  const double error = own > most_own ? 1 : own + left * (1 - own), cost = shared.cost + rays;
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

}  // namespace

Gains find_gains(const Pilot& pilot, const KernelOptions& options, const OpenChoices& open,
                 const LightPathsJob& light_paths_job) {
  const bool both = options.light_paths && open.caustics;
  const std::vector<TechniqueFigures> figures = try_techniques(pilot, techniques_of(options, both));
  if (figures.empty()) return {};
  const std::size_t ways = options.suffixes > 0 ? 2 : 1;
  const Ways rest{figures[0], figures[ways - 1]};
  Gains gains;
  if (!options.light_paths) {
    gains.sharing_by_chance = products_of(rest, rest, 0, 0, 0).sharing();
    gains.reconstruction_by_chance = gain_of_reconstruction(rest.shared, 0, 0, pilot.list);
    return gains;
  }
  const SplatSums splats = try_light_paths(pilot, options, light_paths_job);
  const CausticErrors caustics(splats, rest.plain.brightness);
  const Products by_light = products_of(rest, rest, caustics.by_light, caustics.by_light, splats.rays);
  gains.sharing_by_lights = by_light.sharing();
  gains.reconstruction_by_lights =
      gain_of_reconstruction(rest.shared, caustics.by_light, splats.rays, pilot.list);
  if (!both || !(max_component(splats.radiance) > 0)) return gains;
  const Ways chance{figures[ways], figures.back()};
  const double left = left_by_sharing(rest, chance, caustics.by_chance);
  const Products by_chance = products_of(chance, rest, caustics.by_chance, caustics.by_chance * left, 0);
  gains.sharing_by_chance = by_chance.sharing();
  gains.reconstruction_by_chance =
      gain_of_reconstruction(rest.shared, caustics.by_chance * left, 0, pilot.list);
  gains.light_paths = by_chance.least(open.sharing) / by_light.least(open.sharing);
  return gains;
}

}  // namespace castray
