#include "wavefront/pilot_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "core/sequences.h"

namespace castray {

namespace {

/// Of the image's tiles, one in so many; and no more than suffice.
constexpr int sparseness = 8, most_tiles = 48;
constexpr std::size_t replicates = 2, most_samples = 4;

/// In rays: what a pixel's gathering from one thing that a tile shares costs where a shaft answers for the
/// tile, and where a ray is asked; and the BSDFs that this evaluates. Fitted to the times of scenes of many
/// kinds, within a third of each. Over a list a ray costs a fourth of one over a tree, and all else is dearer
/// by comparison.
struct Costs {
  double gathered, asked, evaluated;
};
constexpr Costs over_list{0.075, 0.8, 0.18}, over_tree{0.075, 0.8, 0.05};

double cost_of(const TileResult& r, const Costs& costs) {
  return static_cast<double>(r.rays - r.gathered) +
         costs.gathered * static_cast<double>(r.gathered - r.asked) +
         costs.asked * static_cast<double>(r.asked) + costs.evaluated * static_cast<double>(r.evaluated);
}

using TilePixels = std::array<Vec3d, tile_pixels>;

/// What one technique made of one tile.
struct TileRun {
  std::size_t samples;
  TilePixels sample[replicates][most_samples] = {};
};

/// Tiles of one group, which one job renders.
using Group = std::vector<TilePlace>;

/// Tiles of 8x8 pixels, the last one perhaps in part.
int tiles_along(int pixels) { return (pixels + tile_size - 1) / tile_size; }

/// Of images so small that a job's are more than a pilot of a few per cent can try, half as many.
std::size_t tiles_of_group(const Pilot& pilot, Samples samples) {
  constexpr int small = 32 * max_tiles;
  const bool half = samples == Samples::one && tiles_along(pilot.width) * tiles_along(pilot.height) <= small;
  return half ? max_tiles / 2 : max_tiles;
}

/// Point `number` of a sequence of low discrepancy over the grid (Roberts 2018, R2).
TilePlace tile_at(const Pilot& pilot, std::size_t number) {
  const auto at = [number](int pixels, double step) {
    const double u = 0.5 + static_cast<double>(number) * step;
    return static_cast<int>((u - std::floor(u)) * tiles_along(pixels));
  };
  const int x = at(pilot.width, 0.7548776662466927), y = at(pilot.height, 0.5698402909980532);
  return {x * tile_size, y * tile_size, x, y};
}

/// As in a render, whose grid moves with every sample, a tile is not the same one of the grid in each.
Group in_moved_grid(Group tiles, std::uint32_t seed, std::uint32_t sample) {
  const std::uint32_t moved = hash_combine(seed, sample);
  for (TilePlace& tile : tiles) {
    tile.grid_x += static_cast<int>(moved & 1);
    tile.grid_y += static_cast<int>(moved >> 1 & 1);
  }
  return tiles;
}

/// What one technique made of the tiles of a group.
struct GroupRun {
  std::vector<TileRun> tiles;
  double cost[replicates][most_samples] = {};  ///< in rays
};

void render_sample(const Pilot& pilot, KernelOptions options, const Group& group, std::uint32_t replicate,
                   std::uint32_t sample, GroupRun& run) {
  options.ragged = 0;  // each pixel keeps its place in the result
  options.seed = hash_combine(0x9170fu, replicate);
  const Group places = in_moved_grid(group, options.seed, sample);
  TileJob job{};
  job.tiles = static_cast<int>(group.size());
  job.sample = sample;
  job.places = places.data();
  std::vector<std::uint32_t> place(2 * batch_size);
  std::vector<float> values(6 * batch_size);
  const auto part = [&](std::size_t c) { return &values[c * batch_size]; };
  TileResult result{&place[0], &place[batch_size],         {part(0), part(1), part(2)}, 0, 0, 0,
                    0,         {part(3), part(4), part(5)}};
  pilot.render_job(options, job, result);
  for (std::size_t i = 0; i < group.size() * tile_pixels; ++i) {
    Vec3d radiance;
    for (int c = 0; c < 3; ++c) radiance[c] = double{result.radiance[c][i]} - double{result.emitted[c][i]};
    if (is_finite(radiance)) run.tiles[i / tile_pixels].sample[replicate][sample][i % tile_pixels] = radiance;
  }
  run.cost[replicate][sample] = cost_of(result, pilot.list ? over_list : over_tree);
}

/// By technique.
std::vector<GroupRun> render_group(const Pilot& pilot, const std::vector<KernelOptions>& techniques,
                                   const Group& group, std::size_t samples) {
  const std::size_t jobs = replicates * samples;
  std::vector<GroupRun> runs(techniques.size(),
                             GroupRun{std::vector<TileRun>(group.size(), TileRun{samples})});
#pragma omp parallel for schedule(dynamic) num_threads(pilot.threads)
  for (std::size_t i = 0; i < techniques.size() * jobs; ++i)
    render_sample(pilot, techniques[i / jobs], group, static_cast<std::uint32_t>(i % jobs / samples),
                  static_cast<std::uint32_t>(i % samples), runs[i / jobs]);
  return runs;
}

double cost_of(const GroupRun& run) {
  double sum = 0;
  for (const auto& replicate : run.cost)
    for (const double cost : replicate) sum += cost;
  return sum;
}

double samples_of(const TileRun& run) { return static_cast<double>(replicates * run.samples * tile_pixels); }

Vec3d mean_of_tile(const TileRun& run) {
  Vec3d sum;
  for (const auto& replicate : run.sample)
    for (const TilePixels& pixels : replicate)
      for (const Vec3d& pixel : pixels) sum += pixel;
  return sum / samples_of(run);
}

using PixelErrors = std::array<double, tile_pixels>;

/// The errors of pixels' means over `count` samples; see TechniqueFigures.
PixelErrors pixel_errors(const TileRun& run, std::size_t count, const Vec3d& brightness) {
  PixelErrors errors{};
  for (std::size_t first = 0; first < run.samples; first += count)
    for (std::size_t i = 0; i < tile_pixels; ++i) {
      Vec3d sum, squares;
      for (const auto& replicate : run.sample) {
        Vec3d mean;
        for (std::size_t s = first; s < first + count; ++s) mean += replicate[s][i] / double(count);
        sum += mean;
        squares += mean * mean;
      }
      for (int c = 0; c < 3; ++c)
        errors[i] += std::max(squares[c] - sum[c] * sum[c] / replicates, 0.0) / (replicates - 1) /
                     (brightness[c] * brightness[c] + 0.01);
    }
  const std::size_t means = run.samples / count;
  for (double& error : errors) error *= double(count) / double(means);
  return errors;
}

double mean_of(const PixelErrors& errors) {
  double sum = 0;
  for (const double error : errors) sum += error;
  return sum / tile_pixels;
}

double relative_error(const TileRun& run, std::size_t count, const Vec3d& brightness) {
  return mean_of(pixel_errors(run, count, brightness));
}

/// What the worst pixel has beyond a few others: not if they see an edge, but if a sample of its own is
/// bright.
double lonely_error(PixelErrors errors) {
  constexpr std::size_t others = 3;
  std::nth_element(errors.begin(), errors.begin() + others, errors.end(), std::greater<>());
  return (*std::max_element(errors.begin(), errors.end()) - errors[others]) / tile_pixels;
}

/// Half of the error of differences of neighbours: as that of pixels if their noise is their own.
double difference_error(const TileRun& run, const Vec3d& brightness) {
  constexpr int pairs = 2 * tile_size * (tile_size - 1);
  double error = 0;
  for (const int step : {1, tile_size}) {  // to the right, below
    TileRun differences{run.samples};
    for (std::size_t r = 0; r < replicates; ++r)
      for (std::size_t s = 0; s < run.samples; ++s)
        for (int i = 0; i + step < tile_pixels; ++i) {
          const TilePixels& pixels = run.sample[r][s];
          const auto here = static_cast<std::size_t>(i), there = static_cast<std::size_t>(i + step);
          const bool last_column = step == 1 && there % tile_size == 0;
          if (!last_column) differences.sample[r][s][here] = pixels[there] - pixels[here];
        }
    error += relative_error(differences, run.samples, brightness);
  }
  return error / 2 * tile_pixels / pairs;
}

/// The covariance of what two techniques make of pixels, as an error.
double camera_error(const TileRun& one, const TileRun& other, const Vec3d& brightness) {
  const auto difference = [](const TileRun& run, std::size_t pixel) {  // of the replicates' means
    Vec3d sum;
    for (std::size_t s = 0; s < run.samples; ++s) sum += run.sample[0][s][pixel] - run.sample[1][s][pixel];
    return sum / double(run.samples);
  };
  double sum = 0;
  for (std::size_t i = 0; i < tile_pixels; ++i) {
    const Vec3d product = difference(one, i) * difference(other, i);
    for (int c = 0; c < 3; ++c) sum += product[c] / (brightness[c] * brightness[c] + 0.01);
  }
  return std::max(sum, 0.0) / (replicates * tile_pixels) * double(one.samples);
}

/// Errors are relative to what the techniques make of the tile on average.
std::vector<TechniqueFigures> figures_of(const std::vector<GroupRun>& runs, std::size_t tile, bool matte) {
  Vec3d brightness;
  for (const GroupRun& run : runs) brightness += mean_of_tile(run.tiles[tile]) / double(runs.size());
  std::vector<TechniqueFigures> figures;
  const bool alike = matte && runs.size() > 1;
  const double of_camera = alike ? camera_error(runs[0].tiles[tile], runs[1].tiles[tile], brightness) : 0;
  for (const GroupRun& group : runs) {
    const TileRun& run = group.tiles[tile];
    const PixelErrors errors = pixel_errors(run, run.samples, brightness);
    const double error = mean_of(errors);
    const double tiles = static_cast<double>(group.tiles.size());
    figures.push_back({mean_of_tile(run), error, run.samples > 1 ? relative_error(run, 1, brightness) : 0,
                       error > 0 ? difference_error(run, brightness) / error : 0, lonely_error(errors),
                       of_camera, cost_of(group) / (tiles * samples_of(run))});
  }
  return figures;
}

using FiguresByTile = std::vector<std::vector<TechniqueFigures>>;

/// Of technique k; see TechniqueFigures.
double own_share(const FiguresByTile& by_tile, std::size_t k) {
  double error = 0, own = 0;
  for (const auto& tile : by_tile) {
    error += tile[k].error;
    own += tile[k].error * tile[k].own_share;
  }
  return error > 0 ? own / error : 1;
}

/// Lowers each technique's errors of an eighth of the tiles, the worst ones, to that of the next: few bright
/// samples, that any technique might have met, would decide alone.
void lower_greatest(FiguresByTile& by_tile) {
  constexpr std::size_t part = 8;
  const std::size_t lowered = (by_tile.size() + part - 1) / part;
  for (std::size_t k = 0, count = by_tile.front().size(); k < count; ++k) {
    const auto next = by_tile.begin() + static_cast<std::ptrdiff_t>(lowered);
    std::nth_element(by_tile.begin(), next, by_tile.end(),
                     [k](const auto& a, const auto& b) { return a[k].error > b[k].error; });
    for (auto tile = by_tile.begin(); tile != next; ++tile) {
      (*tile)[k].error = (*next)[k].error;
      (*tile)[k].single_error = std::min((*tile)[k].single_error, (*next)[k].single_error);
    }
  }
}

std::vector<TechniqueFigures> means_over(FiguresByTile by_tile) {
  std::vector<TechniqueFigures> means(by_tile.front().size());
  lower_greatest(by_tile);
  for (std::size_t k = 0; k < means.size(); ++k) means[k].own_share = own_share(by_tile, k);
  const double share = 1.0 / static_cast<double>(by_tile.size());
  for (const std::vector<TechniqueFigures>& tile : by_tile)  // in their order, whatever the threads
    for (std::size_t k = 0; k < means.size(); ++k) {
      means[k].brightness += tile[k].brightness * share;
      means[k].error += tile[k].error * share;
      means[k].single_error += tile[k].single_error * share;
      means[k].lonely_error += tile[k].lonely_error * share;
      means[k].camera_error += std::min(tile[k].camera_error, tile[k].error) * share;
      means[k].cost += tile[k].cost * share;
    }
  return means;
}

}  // namespace

TileTrials::TileTrials(Pilot pilot, std::vector<KernelOptions> techniques, Samples samples)
    : pilot_(std::move(pilot)), techniques_(std::move(techniques)), samples_(samples) {}

double TileTrials::cost_of_group(Samples samples) const {
  const auto paths = [](std::size_t tiles, Samples of_tile) { return double(tiles) * double(of_tile); };
  return cost_ * paths(tiles_of_group(pilot_, samples), samples) / paths(tiles(), samples_);
}

bool TileTrials::try_more() {
  const int spare = tiles_along(pilot_.width) * tiles_along(pilot_.height) / sparseness;
  Group group(tiles_of_group(pilot_, samples_));
  if (spare < max_tiles || tiles() + group.size() > static_cast<std::size_t>(std::min(most_tiles, spare)))
    return false;
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = tile_at(pilot_, tiles() + i);
  const std::vector<GroupRun> runs =
      render_group(pilot_, techniques_, group, static_cast<std::size_t>(samples_));
  for (const GroupRun& run : runs) cost_ += cost_of(run);
  for (std::size_t i = 0; i < group.size(); ++i) by_tile_.push_back(figures_of(runs, i, pilot_.matte));
  return true;
}

std::vector<TechniqueFigures> TileTrials::figures() const { return means_over(by_tile_); }

std::vector<TechniqueFigures> TileTrials::figures_without(std::size_t tile) const {
  FiguresByTile others = by_tile_;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(tile));
  return means_over(std::move(others));
}

}  // namespace castray
