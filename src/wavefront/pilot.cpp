#include "wavefront/pilot.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "castray/vec.h"
#include "core/sequences.h"

namespace castray {

namespace {

/// Of the image's tiles, one in so many; and no more than suffice.
constexpr int sparseness = 16, most_tiles = 32, fewest_tiles = 4;
constexpr int replicates = 3, samples = 4;

/// In rays: what a pixel's gathering from one thing that a tile shares costs, and the BSDFs that this
/// evaluates. Fitted to the times of scenes of many kinds, lists and trees: within a third of each.
constexpr double cost_of_gathering = 0.12, cost_of_evaluating = 0.055;

/// Means over the samples of one replicate, pixel by pixel.
using PixelMeans = std::vector<Vec3d>;

/// What one technique made of one tile.
struct TileRun {
  PixelMeans mean[replicates];
  double cost = 0;  ///< in rays
};

struct Tile {
  int x, y;  ///< in the grid
};

/// A point set of low discrepancy over the grid (Hammersley's, by the golden ratio).
std::vector<Tile> spread_tiles(int columns, int rows) {
  const int count = std::min(most_tiles, columns * rows / sparseness);
  std::vector<Tile> tiles;
  for (int i = 0; i < count; ++i) {
    constexpr double golden = 0.6180339887498949;
    const double u = (i + 0.5) / count, v = (i + 0.5) * golden - std::floor((i + 0.5) * golden);
    tiles.push_back({static_cast<int>(u * columns), static_cast<int>(v * rows)});
  }
  return tiles;
}

double cost_of(const TileResult& r) {
  return static_cast<double>(r.rays - r.gathered) + cost_of_gathering * static_cast<double>(r.gathered) +
         cost_of_evaluating * static_cast<double>(r.evaluated);
}

TileRun render_tile(KernelOptions options, const Tile& tile, const RenderJob& render_job) {
  std::uint32_t x[batch_size], y[batch_size];
  std::vector<float> radiance(3 * batch_size);
  TileResult result{x, y, {&radiance[0], &radiance[batch_size], &radiance[2 * batch_size]}, 0, 0, 0};
  TileRun run;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    options.seed = hash_combine(0x9170fu, r);
    run.mean[r].assign(tile_pixels, Vec3d());
    for (std::uint64_t s = 0; s < samples; ++s) {
      render_job(options, {tile.x * tile_size, tile.y * tile_size, tile.x, tile.y, 1, s}, result);
      for (std::size_t i = 0; i < tile_pixels; ++i) {
        const Vec3d sample(result.radiance[0][i], result.radiance[1][i], result.radiance[2][i]);
        if (is_finite(sample)) run.mean[r][i] += sample / samples;
      }
    }
  }
  run.cost = cost_of(result);
  return run;
}

void subtract(TileRun& from, const TileRun& seen) {
  for (int r = 0; r < replicates; ++r)
    for (std::size_t i = 0; i < tile_pixels; ++i) from.mean[r][i] = from.mean[r][i] - seen.mean[r][i];
}

Vec3d mean_of_tile(const TileRun& run) {
  Vec3d sum;
  for (const PixelMeans& pixels : run.mean)
    for (const Vec3d& pixel : pixels) sum += pixel;
  return sum / double(replicates * tile_pixels);
}

/// The sum over pixels and channels of the variance over replicates, relative to the tile's brightness.
double relative_variance(const TileRun& run, const Vec3d& brightness) {
  double error = 0;
  for (std::size_t i = 0; i < tile_pixels; ++i)
    for (int c = 0; c < 3; ++c) {
      double sum = 0, squares = 0;
      for (const PixelMeans& pixels : run.mean) {
        sum += pixels[i][c];
        squares += pixels[i][c] * pixels[i][c];
      }
      const double variance = std::max(squares - sum * sum / replicates, 0.0) / (replicates - 1);
      error += variance / (brightness[c] * brightness[c] + 0.01);
    }
  return error;
}

struct Figures {
  double error = 0, cost = 0;
};

/// Of shared and of plain paths on one tile.
struct TileFigures {
  Figures shared, plain;
};

TileFigures try_tile(const KernelOptions& options, const Tile& tile, const RenderJob& render_job) {
  KernelOptions shared = options, plain = options;
  shared.ragged = plain.ragged = 0;  // each pixel keeps its place in the result
  plain.suffixes = 0;
  KernelOptions emission = plain;
  emission.max_depth = 1;
  const TileRun seen = render_tile(emission, tile, render_job);
  TileRun by_sharing = render_tile(shared, tile, render_job), alone = render_tile(plain, tile, render_job);
  subtract(by_sharing, seen);
  subtract(alone, seen);
  const Vec3d brightness = (mean_of_tile(by_sharing) + mean_of_tile(alone)) / 2.0;
  return {{relative_variance(by_sharing, brightness), by_sharing.cost},
          {relative_variance(alone, brightness), alone.cost}};
}

/// Plain paths on one tile, per pixel and sample.
struct PlainFigures {
  Vec3d brightness;
  Figures figures;
};

PlainFigures try_plain(KernelOptions plain, const Tile& tile, const RenderJob& render_job) {
  plain.suffixes = 0;
  plain.ragged = 0;
  KernelOptions emission = plain;
  emission.max_depth = 1;
  TileRun run = render_tile(plain, tile, render_job);
  subtract(run, render_tile(emission, tile, render_job));
  const Vec3d brightness = mean_of_tile(run);
  const double pixels = tile_pixels;
  return {
      brightness,
      {relative_variance(run, brightness) * samples / pixels, run.cost / (replicates * samples * pixels)}};
}

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
SplatSums try_light_paths(KernelOptions options, int width, int height, int threads,
                          const LightPathsJob& light_paths_job) {
  options.seed = hash_combine(0x9170fu, 0u);
  std::vector<SplatSums> batches(pilot_batches);
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (std::size_t i = 0; i < pilot_batches; ++i) {
    const SplatSink sink{
        &batches[i], [](void* self, const Splats& splats) { static_cast<SplatSums*>(self)->add(splats); }};
    batches[i].rays =
        static_cast<double>(light_paths_job(options, {0, i * batch_size, batch_size, width, height}, sink));
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

std::vector<Tile> tiles_of(int width, int height) {
  const auto in_tiles = [](int pixels) { return (pixels + tile_size - 1) / tile_size; };
  return spread_tiles(in_tiles(width), in_tiles(height));
}

}  // namespace

std::optional<double> gain_of_sharing(const KernelOptions& shared, int width, int height, int threads,
                                      const RenderJob& render_job) {
  const std::vector<Tile> tiles = tiles_of(width, height);
  if (tiles.size() < fewest_tiles) return {};
  std::vector<TileFigures> figures(tiles.size());
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (std::size_t i = 0; i < tiles.size(); ++i) figures[i] = try_tile(shared, tiles[i], render_job);
  TileFigures sum;  // in the tiles' order, whatever the threads
  for (const TileFigures& f : figures) {
    sum.shared.error += f.shared.error;
    sum.shared.cost += f.shared.cost;
    sum.plain.error += f.plain.error;
    sum.plain.cost += f.plain.cost;
  }
  if (!(sum.shared.error > 0) || !(sum.plain.error > 0)) return {};
  return sum.plain.error * sum.plain.cost / (sum.shared.error * sum.shared.cost);
}

std::optional<double> gain_of_light_paths(const KernelOptions& options, int width, int height, int threads,
                                          const RenderJob& render_job, const LightPathsJob& light_paths_job) {
  const std::vector<Tile> tiles = tiles_of(width, height);
  if (tiles.size() < fewest_tiles) return {};
  std::vector<PlainFigures> plain(tiles.size());
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (std::size_t i = 0; i < tiles.size(); ++i) plain[i] = try_plain(options, tiles[i], render_job);
  PlainFigures rest;  // means over the tiles, in their order
  for (const PlainFigures& p : plain) {
    const double share = 1.0 / static_cast<double>(tiles.size());
    rest.brightness += p.brightness * share;
    rest.figures.error += p.figures.error * share;
    rest.figures.cost += p.figures.cost * share;
  }
  const SplatSums splats = try_light_paths(options, width, height, threads, light_paths_job);
  if (!(max_component(splats.radiance) > 0)) return {};
  double by_light = 0, by_chance = 0;
  for (int c = 0; c < 3; ++c) {
    const double brightness = rest.brightness[c] + splats.radiance[c];
    by_light += splats.by_light[c] / (brightness * brightness + 0.01);
    by_chance += splats.by_chance[c] / (brightness * brightness + 0.01);
  }
  return (rest.figures.error + by_chance) * rest.figures.cost /
         ((rest.figures.error + by_light) * (rest.figures.cost + splats.rays));
}

}  // namespace castray
