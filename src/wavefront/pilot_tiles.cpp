#include "wavefront/pilot_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/sequences.h"

namespace castray {

namespace {

/// Of the image's tiles, one in so many; and no more than suffice.
constexpr int sparseness = 8, most_tiles = 48, fewest_tiles = 8;
constexpr std::size_t replicates = 2, samples = 4;

/// In rays: what a pixel's gathering from one thing that a tile shares costs where a shaft answers for the
/// tile, and where a ray is asked; and the BSDFs that this evaluates. Fitted to the times of scenes of many
/// kinds, within a third of each. Over a list a ray costs a fourth of one over a tree, and all else is dearer
/// by comparison.
struct Costs {
  double gathered, asked, evaluated;
};
constexpr Costs over_list{0.075, 0.8, 0.18}, over_tree{0.02, 0.8, 0.04};

double cost_of(const TileResult& r, const Costs& costs) {
  return static_cast<double>(r.rays - r.gathered) +
         costs.gathered * static_cast<double>(r.gathered - r.asked) +
         costs.asked * static_cast<double>(r.asked) + costs.evaluated * static_cast<double>(r.evaluated);
}

using TilePixels = std::array<Vec3d, tile_pixels>;

/// What one technique made of one tile.
struct TileRun {
  TilePixels sample[replicates][samples] = {};
  double cost = 0;  ///< in rays
};

struct Tile {
  int x, y;  ///< in the grid
};

/// A point set of low discrepancy over the grid (Hammersley's, by the golden ratio).
std::vector<Tile> spread_tiles(const Pilot& pilot) {
  const auto in_tiles = [](int pixels) { return (pixels + tile_size - 1) / tile_size; };
  const int columns = in_tiles(pilot.width), rows = in_tiles(pilot.height);
  const int count = std::min(most_tiles, columns * rows / sparseness);
  std::vector<Tile> tiles;
  for (int i = 0; count >= fewest_tiles && i < count; ++i) {
    constexpr double golden = 0.6180339887498949;
    const double u = (i + 0.5) / count, v = (i + 0.5) * golden - std::floor((i + 0.5) * golden);
    tiles.push_back({static_cast<int>(u * columns), static_cast<int>(v * rows)});
  }
  return tiles;
}

/// A sample of a tile. As in a render, whose grid moves with every sample, the tile is not the same one of
/// the grid in each.
TileJob job_of(const Tile& tile, std::uint32_t seed, std::uint32_t sample) {
  const std::uint32_t moved = hash_combine(seed, sample);
  return {.x = tile.x * tile_size,
          .y = tile.y * tile_size,
          .grid_x = tile.x + static_cast<int>(moved & 1),
          .grid_y = tile.y + static_cast<int>(moved >> 1 & 1),
          .tiles = 1,
          .sample = sample};
}

TileRun render_tile(const Pilot& pilot, KernelOptions options, const Tile& tile) {
  options.ragged = 0;  // each pixel keeps its place in the result
  std::uint32_t x[batch_size], y[batch_size];
  std::vector<float> radiance(3 * batch_size);
  TileResult result{x, y, {&radiance[0], &radiance[batch_size], &radiance[2 * batch_size]}, 0, 0, 0, 0};
  TileRun run;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    options.seed = hash_combine(0x9170fu, r);
    for (std::uint32_t s = 0; s < samples; ++s) {
      pilot.render_job(options, job_of(tile, options.seed, s), result);
      for (std::size_t i = 0; i < tile_pixels; ++i) {
        const Vec3d sample(result.radiance[0][i], result.radiance[1][i], result.radiance[2][i]);
        if (is_finite(sample)) run.sample[r][s][i] = sample;
      }
    }
  }
  run.cost = cost_of(result, pilot.list ? over_list : over_tree);
  return run;
}

void subtract(TileRun& from, const TileRun& seen) {
  for (std::size_t r = 0; r < replicates; ++r)
    for (std::size_t s = 0; s < samples; ++s)
      for (std::size_t i = 0; i < tile_pixels; ++i)
        from.sample[r][s][i] = from.sample[r][s][i] - seen.sample[r][s][i];
}

Vec3d mean_of_tile(const TileRun& run) {
  Vec3d sum;
  for (const auto& replicate : run.sample)
    for (const TilePixels& pixels : replicate)
      for (const Vec3d& pixel : pixels) sum += pixel;
  return sum / double(replicates * samples * tile_pixels);
}

/// The error of means over `count` samples; see TechniqueFigures.
double relative_error(const TileRun& run, std::size_t count, const Vec3d& brightness) {
  double error = 0;
  for (std::size_t first = 0; first < samples; first += count)
    for (std::size_t i = 0; i < tile_pixels; ++i) {
      Vec3d sum, squares;
      for (const auto& replicate : run.sample) {
        Vec3d mean;
        for (std::size_t s = first; s < first + count; ++s) mean += replicate[s][i] / double(count);
        sum += mean;
        squares += mean * mean;
      }
      for (int c = 0; c < 3; ++c)
        error += std::max(squares[c] - sum[c] * sum[c] / replicates, 0.0) / (replicates - 1) /
                 (brightness[c] * brightness[c] + 0.01);
    }
  const std::size_t means = samples / count;
  return error * double(count) / double(means * tile_pixels);
}

/// Half of the error of differences of neighbours: as that of pixels if their noise is their own.
double difference_error(const TileRun& run, const Vec3d& brightness) {
  constexpr int pairs = 2 * tile_size * (tile_size - 1);
  double error = 0;
  for (const int step : {1, tile_size}) {  // to the right, below
    TileRun differences;
    for (std::size_t r = 0; r < replicates; ++r)
      for (std::size_t s = 0; s < samples; ++s)
        for (int i = 0; i + step < tile_pixels; ++i) {
          const TilePixels& pixels = run.sample[r][s];
          const auto here = static_cast<std::size_t>(i), there = static_cast<std::size_t>(i + step);
          const bool last_column = step == 1 && there % tile_size == 0;
          if (!last_column) differences.sample[r][s][here] = pixels[there] - pixels[here];
        }
    error += relative_error(differences, samples, brightness);
  }
  return error / 2 * tile_pixels / pairs;
}

/// Errors are relative to what the techniques make of the tile on average.
std::vector<TechniqueFigures> try_tile(const Pilot& pilot, const std::vector<KernelOptions>& techniques,
                                       const Tile& tile) {
  KernelOptions emission = techniques[0];
  emission.suffixes = 0;
  emission.max_depth = 1;
  const TileRun seen = render_tile(pilot, emission, tile);
  std::vector<TileRun> runs;
  Vec3d brightness;
  for (const KernelOptions& technique : techniques) {
    runs.push_back(render_tile(pilot, technique, tile));
    subtract(runs.back(), seen);
    brightness += mean_of_tile(runs.back()) / double(techniques.size());
  }
  std::vector<TechniqueFigures> figures;
  for (const TileRun& run : runs) {
    const double error = relative_error(run, samples, brightness);
    figures.push_back({mean_of_tile(run), error, relative_error(run, 1, brightness),
                       error > 0 ? difference_error(run, brightness) / error : 0,
                       run.cost / double(replicates * samples * tile_pixels)});
  }
  return figures;
}

/// Of technique k; see TechniqueFigures.
double own_share(const std::vector<std::vector<TechniqueFigures>>& by_tile, std::size_t k) {
  double error = 0, own = 0, worst = 0;
  for (const auto& tile : by_tile) {
    error += tile[k].error;
    own += tile[k].error * tile[k].own_share;
    worst = std::max(worst, tile[k].error);
  }
  return error > 0 ? (own + worst) / (error + worst) : 1;
}

/// Of each technique the tile with the greatest error: a single bright sample that any of them might have met
/// would decide alone.
void leave_out_worst(std::vector<std::vector<TechniqueFigures>>& by_tile) {
  for (std::size_t k = 0, count = by_tile.front().size(); k < count; ++k)
    by_tile.erase(std::max_element(by_tile.begin(), by_tile.end(),
                                   [k](const auto& a, const auto& b) { return a[k].error < b[k].error; }));
}

}  // namespace

std::vector<TechniqueFigures> try_techniques(const Pilot& pilot,
                                             const std::vector<KernelOptions>& techniques) {
  const std::vector<Tile> tiles = spread_tiles(pilot);
  if (tiles.empty()) return {};
  std::vector<std::vector<TechniqueFigures>> by_tile(tiles.size());
#pragma omp parallel for schedule(dynamic) num_threads(pilot.threads)
  for (std::size_t i = 0; i < tiles.size(); ++i) by_tile[i] = try_tile(pilot, techniques, tiles[i]);
  std::vector<TechniqueFigures> means(techniques.size());
  for (std::size_t k = 0; k < means.size(); ++k) means[k].own_share = own_share(by_tile, k);
  leave_out_worst(by_tile);
  const double share = 1.0 / static_cast<double>(by_tile.size());
  for (const std::vector<TechniqueFigures>& tile : by_tile)  // in their order, whatever the threads
    for (std::size_t k = 0; k < means.size(); ++k) {
      means[k].brightness += tile[k].brightness * share;
      means[k].error += tile[k].error * share;
      means[k].single_error += tile[k].single_error * share;
      means[k].cost += tile[k].cost * share;
    }
  return means;
}

}  // namespace castray
