#include "wavefront/wavefront_run.h"

#include <omp.h>

#include <algorithm>
#include <bit>

#include "core/sequences.h"
#include "core/vector_clones.h"
#include "wavefront/kernel_options.h"
#include "wavefront/repeated_tiles.h"
#include "wavefront/tile_grid.h"

namespace castray {

namespace {

Vec3f radiance_of(const TileResult& result, int i) {
  return {result.radiance[0][i], result.radiance[1][i], result.radiance[2][i]};
}

/// Whether no pixel of a tile has an infinite radiance, or one that is no number.
CASTRAY_VECTOR_CLONES
bool all_finite(const TileSamples& tile) {
  constexpr std::uint32_t exponent = 0x7f800000;
  std::uint32_t any = 0;
  for (const float* channel : tile.radiance)
    for (int i = 0; i < tile_pixels; ++i)
      any |= (std::bit_cast<std::uint32_t>(channel[i]) & exponent) == exponent ? 1u : 0u;
  return any == 0;
}

/// The sample of a half of the film that keeps differences: even and odd indices count up two sequences with
/// scrambles of their own, so that the halves are independent. Replicates stay what they are.
std::uint64_t sample_of_half(std::uint64_t sample) {
  constexpr std::uint64_t within = replicate_length - 1;
  return (sample & ~within) | (sample & within) >> 1;
}
std::uint32_t seed_of_half(std::uint32_t seed, std::uint64_t sample) {
  return hash_combine(seed, 0x4a1fu + static_cast<std::uint32_t>(sample & 1));
}
std::uint32_t seed_of_take(std::uint32_t seed, int take) {
  return take == 0 ? seed : hash_combine(seed, 0x7a4eu + static_cast<std::uint32_t>(take));
}

}  // namespace

WavefrontRun::WavefrontRun(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data,
                           const Plan& plan, const Job& job)
    : window_(job.window),
      scene_(data.view),
      differences_(keeps_differences(job.options, plan)),
      edge_samples_(differences_ ? plan.edge_samples : 1),
      edge_emission_(scene, kernel, data, window_, job.options),
      options_(kernel_options(job.options, plan, differences_)),
      render_tiles_(kernel.render_tiles[plan.features]),
      trace_light_paths_(options_.light_paths ? kernel.trace_light_paths[plan.features] : nullptr),
      light_paths_per_pixel_(plan.light_paths_per_pixel),
      bands_((window_.height() + tile_size - 1) / tile_size + 1),
      row_locks_(static_cast<std::size_t>(bands_)) {
  if (job.options.camera) look_through(scene_, *job.options.camera, window_.full_width, window_.full_height);
  for (int i = 0; i < job.threads; ++i) workplaces_.emplace_back(kernel);
  if (!job.options.jitter && !scene_.camera.has_lens && !scene_.geometry.tree.partial.triangles &&
      !data.instances)
    find_first_hits();
  if (differences_) {
    edges_ = PixelEdges(scene, kernel, data, window_, job.threads);
    scene_.edges = edges_.table();
  }
}

void WavefrontRun::render_band(int row, const SampleRange& samples, const SampleMap& map, Film& film,
                               RowStats& stats) {
  const int columns = (window_.width() + 2 * ragged_reach) / tile_size + 2;
  for (int column = 0; column < columns; column += max_tiles)
    for (std::uint64_t s = samples.first; s < samples.first + samples.count; ++s)
      for (Take take{s, 0, takes_of(s)}; take.number < take.of; ++take.number)
        render_take(take, row, column, map, film, stats);
  for (std::uint64_t s = samples.first; trace_light_paths_ && s < samples.first + samples.count; ++s)
    trace_light_paths(row, s, film, stats);
}

int WavefrontRun::takes_of(std::uint64_t sample) const {
  const bool first = sample % replicate_length == 0;
  return differences_ && first && options_.suffixes >= DifferenceSums::most_takes ? DifferenceSums::most_takes
                                                                                  : 1;
}

void WavefrontRun::render_take(const Take& take, int row, int column, const SampleMap& map, Film& film,
                               RowStats& stats) {
  Workplace& workplace = workplaces_[static_cast<std::size_t>(omp_get_thread_num())];
  TileResult result = workplace.tiles.result(differences_);
  KernelOptions options = options_;
  if (differences_) options.seed = seed_of_half(options_.seed, take.sample);
  const std::uint64_t drawn = differences_ ? sample_of_half(take.sample) : take.sample;
  if (take.of > 1) options.ragged = 0;  // grids half a tile apart hide each other's edges
  const TileGrid grid(window_, options, drawn, take.number);
  options.suffixes /= take.of;
  options.seed = seed_of_take(options.seed, take.number);
  const int x0 = grid.x0 + column, x1 = std::min(x0 + max_tiles, grid.x1);
  for (int y = grid.y0 + row; y < grid.y1; y += bands_)
    for (int x = x0; x < x1;) {
      TileJob job = grid.job(x, x1, y, take.sample, map);
      x += std::max(job.tiles, 1);
      if (job.tiles == 0) continue;
      job.sample = drawn;
      // what pixels see of an edge is the better spread the longer the sequence of their camera rays: it is
      // one for both halves, as these pixels have no part in differences
      job.edge_sample = take.sample * static_cast<std::uint64_t>(edge_samples_);
      job.edge_seed = seed_of_take(options_.seed, take.number);
      render_job(job, options, workplace, result);
      job.sample = take.sample;
      if (differences_)
        add_tiles(job, take, grid.reach, result, map, film, stats);
      else
        add(job, grid.reach, result, map, film, stats);
    }
  stats.rays += result.rays;
}

void WavefrontRun::render_job(const TileJob& job, const KernelOptions& options, Workplace& workplace,
                              TileResult& result) const {
  const auto render = [&](const TileJob& part, TileResult& to) {
    render_tiles_(scene_, options, part, workplace.scratch.get(), to);
  };
  if (edge_samples_ == 1) return render(job, result);
  const RepeatedTiles tiles(job, edges_, edge_samples_);
  if (!tiles.any_repeated()) return render(job, result);
  TileResult part = workplace.repeats.result(true);
  tiles.render([&](const TileJob& some) { render(some, part); }, part, result);
  result.rays += part.rays;
}

void WavefrontRun::find_first_hits() {
  constexpr int margin = 2 * tile_size;
  FirstHits& table = scene_.first_hits;
  table.x0 = window_.x0 - margin;
  table.y0 = window_.y0 - margin;
  table.width = window_.width() + 2 * margin;
  table.height = window_.height() + 2 * margin;
  const std::size_t pixels = static_cast<std::size_t>(table.width) * static_cast<std::size_t>(table.height);
  constexpr std::size_t largest = std::size_t{1} << 29;  // vectors index with 31 bits of bytes
  if (pixels > largest) return;
  first_hits_.resize(3 * pixels);
  first_primitives_.resize(pixels);
  table.t = &first_hits_[0];
  table.b1 = &first_hits_[pixels];
  table.b2 = &first_hits_[2 * pixels];
  table.primitive = &first_primitives_[0];
#pragma omp parallel for schedule(dynamic) num_threads(static_cast <int>(workplaces_.size()))
  for (int y = 0; y < table.height; y += tile_size) {
    Workplace& workplace = workplaces_[static_cast<std::size_t>(omp_get_thread_num())];
    TileResult result = workplace.tiles.result(false);
    for (int x = 0; x < table.width; x += max_tiles * tile_size) {
      const TileJob job{table.x0 + x, table.y0 + y, 0, 0, max_tiles, options_.ragged};
      render_tiles_(scene_, options_, job, workplace.scratch.get(), result);
    }
  }
  table.known = true;
}

bool WavefrontRun::keeps(int x, int y, std::uint64_t sample, const Vec3f& radiance, const SampleMap& map,
                         RowStats* stats) const {
  if (x < window_.x0 || x >= window_.x1 || y < window_.y0 || y >= window_.y1 || !map.wants(x, y, sample))
    return false;
  if (stats && !is_finite(radiance)) stats->nonfinite.push_back({x, y, sample});
  return is_finite(radiance);
}

void WavefrontRun::add(const TileJob& job, int reach, const TileResult& result, const SampleMap& map,
                       Film& film, RowStats& stats) {
  const int count = job.tiles * tile_pixels;
  const int first = std::max(job.y - reach, window_.y0);
  const int last = std::min(job.y + tile_size + reach, window_.y1) - 1;
  for (int l = lock_of(first); first <= last && l <= lock_of(last); ++l) {
    const std::lock_guard lock(row_locks_[static_cast<std::size_t>(l)]);
    for (int i = 0; i < count; ++i) {
      const auto x = static_cast<int>(result.x[i]), y = static_cast<int>(result.y[i]);
      if (y < window_.y0 || lock_of(y) != l) continue;
      const Vec3f radiance = radiance_of(result, i);
      if (keeps(x, y, job.sample, radiance, map, &stats)) film.add(x, y, radiance);
    }
  }
}

void WavefrontRun::trace_light_paths(int row, std::uint64_t sample, Film& film, RowStats& stats) {
  Workplace& workplace = workplaces_[static_cast<std::size_t>(omp_get_thread_num())];
  struct Receiver {
    WavefrontRun& run;
    std::uint64_t sample;
    Film& film;
    RowStats& stats;
  } receiver{*this, sample, film, stats};
  const SplatSink sink{&receiver, [](void* self, const Splats& splats) {
                         const Receiver& r = *static_cast<Receiver*>(self);
                         const auto& [red, green, blue] = splats.radiance;
                         for (int i = 0; i < splats.count; ++i)
                           r.run.add_splat(static_cast<int>(splats.x[i]), static_cast<int>(splats.y[i]),
                                           r.sample, {red[i], green[i], blue[i]}, r.film, r.stats);
                       }};
  const int width = window_.full_width, height = window_.full_height;
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  const auto paths = static_cast<std::uint64_t>(light_paths_per_pixel_ * static_cast<double>(pixels));
  const std::uint64_t batches = (paths + batch_size - 1) / batch_size;
  for (auto batch = static_cast<std::uint64_t>(row); batch < batches;
       batch += static_cast<std::uint64_t>(bands_)) {
    const std::uint64_t number = sample % replicate_length * batches + batch;
    const LightPathJob job{sample, number * batch_size, batch_size, width, height};
    stats.rays += trace_light_paths_(scene_, options_, job, workplace.scratch.get(), sink);
    stats.light_paths += batch_size;
  }
}

void WavefrontRun::add_splat(int x, int y, std::uint64_t sample, const Vec3f& radiance, Film& film,
                             RowStats& stats) {
  if (x < window_.x0 || x >= window_.x1 || y < window_.y0 || y >= window_.y1 || radiance == Vec3f()) return;
  if (!is_finite(radiance)) {
    stats.nonfinite.push_back({x, y, sample});
    return;
  }
  const std::lock_guard lock(row_locks_[static_cast<std::size_t>((y - window_.y0) / tile_size)]);
  film.add_splat(x, y, radiance);
}

void WavefrontRun::add_tiles(const TileJob& job, const Take& take, int reach, const TileResult& result,
                             const SampleMap& map, Film& film, RowStats& stats) {
  TileSamples tiles[max_tiles];
  for (int k = 0; k < job.tiles; ++k) tiles[k] = tile_samples(job, take, k, reach > 0, result, map, stats);
  const int first = std::max(job.y - reach, window_.y0),
            end = std::min(job.y + tile_size + reach, window_.y1);
  if (first >= end) return;
  std::unique_lock<std::mutex>
      locks[2 + 2 * ragged_reach / tile_size];  // in one order, so that none waits for ever
  const int first_lock = lock_of(first), last_lock = lock_of(end - 1);
  for (int l = first_lock; l <= last_lock; ++l)
    locks[l - first_lock] = std::unique_lock(row_locks_[static_cast<std::size_t>(l)]);
  film.add({tiles, static_cast<std::size_t>(job.tiles)}, first, end);
}

bool WavefrontRun::wants_all(const TileJob& job, int k, bool ragged, const SampleMap& map) const {
  const int reach = ragged ? ragged_reach : 0;
  const int x0 = job.x + k * tile_size - reach, y0 = job.y - reach, x1 = x0 + tile_size + 2 * reach,
            y1 = y0 + tile_size + 2 * reach;
  return x0 >= window_.x0 && x1 <= window_.x1 && y0 >= window_.y0 && y1 <= window_.y1 &&
         map.wants_all(x0, y0, x1, y1, job.sample);
}

TileSamples WavefrontRun::tile_samples(const TileJob& job, const Take& take, int k, bool ragged,
                                       const TileResult& result, const SampleMap& map,
                                       RowStats& stats) const {
  const int first = k * tile_pixels;
  TileSamples tile{
      .x = job.x + k * tile_size, .y = job.y, .sample = take.sample, .take = take.number, .takes = take.of};
  for (int c = 0; c < 3; ++c) {
    tile.radiance[c] = result.radiance[c] + first;
    tile.emitted[c] = result.emitted[c] + first;
  }
  if (ragged) {
    tile.ragged_x = result.x + first;
    tile.ragged_y = result.y + first;
  }
  const bool whole = wants_all(job, k, ragged, map) && all_finite(tile);
  if (whole) {
    tile.kept = ~std::uint64_t{0};
    tile.smooth = ~result.edges[k];
  }
  for (std::uint64_t left = whole ? result.edges[k] : ~std::uint64_t{0}; left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    const auto x = static_cast<int>(result.x[first + i]), y = static_cast<int>(result.y[first + i]);
    const std::uint64_t bit = std::uint64_t{1} << i;
    const bool smooth = (result.edges[k] & bit) == 0;
    const Vec3f radiance = radiance_of(result, first + i);
    if (x < 0 || x >= window_.full_width || y < 0 || y >= window_.full_height) continue;
    if (keeps(x, y, take.sample, radiance, map, take.is_last() ? &stats : nullptr)) {
      tile.kept |= bit;
      if (!smooth) settle_emission(x, y, take.sample, first + i, result);
    }
    if (smooth && is_finite(radiance)) tile.smooth |= bit;
  }
  return tile;
}

void WavefrontRun::settle_emission(int x, int y, std::uint64_t sample, int i,
                                   const TileResult& result) const {
  if (!edge_emission_.known() || !edges_.of_lamp(x, y)) return;
  const Vec3f seen = edge_emission_.at(x, y, sample);
  for (int c = 0; c < 3; ++c) result.radiance[c][i] += seen[c] - result.emitted[c][i];
}

}  // namespace castray
