#include "wavefront/wavefront.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <optional>

#include "core/sequences.h"
#include "geometry/build_quality.h"
#include "wavefront/choose_kernel.h"
#include "wavefront/edge_emission.h"
#include "wavefront/kernel_scene.h"
#include "wavefront/learn_emission.h"
#include "wavefront/pilot.h"
#include "wavefront/pixel_edges.h"
#include "wavefront/repeated_tiles.h"
#include "wavefront/tile_grid.h"
#include "wavefront/try_lights.h"

namespace castray {

namespace {

/// As kernels ask for it.
constexpr std::align_val_t scratch_alignment{64};
struct FreeScratch {
  void operator()(void* p) const { ::operator delete(p, scratch_alignment); }
};

/// Room for the results of a job.
struct TileBuffers {
  std::vector<float> radiance = std::vector<float>(3 * batch_size),
                     emitted = std::vector<float>(3 * batch_size);
  std::vector<std::uint32_t> place = std::vector<std::uint32_t>(2 * batch_size);

  TileResult result(bool with_emitted) {
    TileResult result{&place[0],
                      &place[batch_size],
                      {&radiance[0], &radiance[batch_size], &radiance[2 * batch_size]},
                      0,
                      0,
                      0,
                      0};
    for (std::size_t c = 0; with_emitted && c < 3; ++c) result.emitted[c] = &emitted[c * batch_size];
    return result;
  }
};

/// What a thread works in.
struct Workplace {
  std::unique_ptr<void, FreeScratch> scratch;
  TileBuffers tiles, repeats;

  explicit Workplace(const KernelApi& kernel)
      : scratch(::operator new(kernel.scratch_bytes, scratch_alignment)) {
    std::memset(scratch.get(), 0, kernel.scratch_bytes);  // indices past the end of a wave must be valid ones
  }
};

/// Splats are spread over their pixels, and no sample's part to clamp.
bool traces_light_paths(const RenderOptions& options, const Plan& plan) {
  return plan.light_paths && options.jitter && !options.clamp_indirect;
}

KernelOptions kernel_options(const RenderOptions& options, const Plan& plan, bool differences) {
  KernelOptions k{};
  k.sobol = options.sampler == SamplerKind::sobol;
  k.jitter = options.jitter;
  k.fixed_roulette = options.rr.has_value();
  k.survival = static_cast<float>(options.rr.value_or(1.0));
  k.max_depth = static_cast<std::uint32_t>(options.max_depth);
  k.most_indirect =
      static_cast<float>(options.clamp_indirect.value_or(std::numeric_limits<double>::infinity()));
  k.mis = plan.mis;
  k.light_paths = traces_light_paths(options, plan);
  k.suffixes = plan.suffixes;
  k.light_points = plan.light_points;
  k.environment_points = plan.environment_points;
  // from then on so many grids lie over each other that none can be told
  constexpr std::uint64_t few_samples = 4;
  k.ragged = plan.suffixes > 0 ? few_samples / (differences ? DifferenceSums::halves : 1) : 0;
  k.seed =
      hash_combine(static_cast<std::uint32_t>(options.seed), static_cast<std::uint32_t>(options.seed >> 32));
  return k;
}

Vec3f radiance_of(const TileResult& result, int i) {
  return {result.radiance[0][i], result.radiance[1][i], result.radiance[2][i]};
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

/// One render of a scene, tile row by tile row.
class WavefrontRun {
 public:
  WavefrontRun(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data, const Plan& plan,
               const Job& job)
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
    if (job.options.camera)
      look_through(scene_, *job.options.camera, window_.full_width, window_.full_height);
    for (int i = 0; i < job.threads; ++i) workplaces_.emplace_back(kernel);
    if (!job.options.jitter && !scene_.camera.has_lens && !scene_.geometry.tree.partial.triangles &&
        !data.instances)
      find_first_hits();
    if (differences_) {
      edges_ = PixelEdges(scene, kernel, data, window_, job.threads);
      scene_.edges = edges_.table();
    }
  }

  /// Tile row `row` of each sample's grid, and the last one or two where the grid has more than there are
  /// bands. A few columns after the other, each with all samples, so that their sums stay in the cache.
  void render_band(int row, const SampleRange& samples, const SampleMap& map, Film& film, RowStats& stats) {
    Workplace& workplace = workplaces_[static_cast<std::size_t>(omp_get_thread_num())];
    TileResult result = workplace.tiles.result(differences_);
    const int columns = (window_.width() + 2 * ragged_reach) / tile_size + 2;
    for (int column = 0; column < columns; column += max_tiles)
      for (std::uint64_t s = samples.first; s < samples.first + samples.count; ++s) {
        KernelOptions options = options_;
        if (differences_) options.seed = seed_of_half(options_.seed, s);
        const std::uint64_t drawn = differences_ ? sample_of_half(s) : s;
        const TileGrid grid(window_, options, drawn);
        const int x0 = grid.x0 + column, x1 = std::min(x0 + max_tiles, grid.x1);
        for (int y = grid.y0 + row; y < grid.y1; y += bands_)
          for (int x = x0; x < x1;) {
            TileJob job = grid.job(x, x1, y, s, map);
            x += std::max(job.tiles, 1);
            if (job.tiles == 0) continue;
            job.sample = drawn;
            // what pixels see of an edge is the better spread the longer the sequence of their camera rays:
            // it is one for both halves, as these pixels have no part in differences
            job.edge_sample = s * static_cast<std::uint64_t>(edge_samples_);
            job.edge_seed = options_.seed;
            render_job(job, grid.reach, options, workplace, result);
            job.sample = s;
            if (differences_)
              add_tiles(job, grid.reach, result, map, film, stats);
            else
              add(job, grid.reach, result, map, film, stats);
          }
      }
    for (std::uint64_t s = samples.first; trace_light_paths_ && s < samples.first + samples.count; ++s)
      trace_light_paths(row, s, workplace, film, stats);
    stats.rays += result.rays;
  }

 private:
  /// Renders a job, its tiles that see an edge several times.
  void render_job(const TileJob& job, int reach, const KernelOptions& options, Workplace& workplace,
                  TileResult& result) const {
    const auto render = [&](const TileJob& part, TileResult& to) {
      render_tiles_(scene_, options, part, workplace.scratch.get(), to);
    };
    if (edge_samples_ == 1) return render(job, result);
    const RepeatedTiles tiles(job, edges_, reach, edge_samples_);
    if (!tiles.any_repeated()) return render(job, result);
    TileResult part = workplace.repeats.result(true);
    tiles.render([&](const TileJob& some) { render(some, part); }, part, result);
    result.rays += part.rays;
  }

  /// All that the tiles of any sample's grid reach.
  void find_first_hits() {
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

  int lock_of(int y) const { return (y - window_.y0) / tile_size; }

  /// Whether the sample of pixel (x,y) counts: it lies in the window, is wanted, and is finite, or is told.
  bool keeps(int x, int y, std::uint64_t sample, const Vec3f& radiance, const SampleMap& map,
             RowStats& stats) const {
    if (x < window_.x0 || x >= window_.x1 || y < window_.y0 || y >= window_.y1 || !map.wants(x, y, sample))
      return false;
    if (!is_finite(radiance)) stats.nonfinite.push_back({x, y, sample});
    return is_finite(radiance);
  }

  /// Adds a job's samples to the film where they lie in its window and are wanted, under the locks of the
  /// rows they share with other jobs.
  void add(const TileJob& job, int reach, const TileResult& result, const SampleMap& map, Film& film,
           RowStats& stats) {
    const int count = job.tiles * tile_pixels;
    const int first = std::max(job.y - reach, window_.y0);
    const int last = std::min(job.y + tile_size + reach, window_.y1) - 1;
    for (int l = lock_of(first); first <= last && l <= lock_of(last); ++l) {
      const std::lock_guard lock(row_locks_[static_cast<std::size_t>(l)]);
      for (int i = 0; i < count; ++i) {
        const auto x = static_cast<int>(result.x[i]), y = static_cast<int>(result.y[i]);
        if (y < window_.y0 || lock_of(y) != l) continue;
        const Vec3f radiance = radiance_of(result, i);
        if (keeps(x, y, job.sample, radiance, map, stats)) film.add(x, y, radiance);
      }
    }
  }

  /// A band's part of a sample's light paths.
  void trace_light_paths(int row, std::uint64_t sample, Workplace& workplace, Film& film, RowStats& stats) {
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

  void add_splat(int x, int y, std::uint64_t sample, const Vec3f& radiance, Film& film, RowStats& stats) {
    if (x < window_.x0 || x >= window_.x1 || y < window_.y0 || y >= window_.y1 || radiance == Vec3f()) return;
    if (!is_finite(radiance)) {
      stats.nonfinite.push_back({x, y, sample});
      return;
    }
    const std::lock_guard lock(row_locks_[static_cast<std::size_t>((y - window_.y0) / tile_size)]);
    film.add_splat(x, y, radiance);
  }

  /// The same for a film that keeps differences: whole tiles.
  void add_tiles(const TileJob& job, int reach, const TileResult& result, const SampleMap& map, Film& film,
                 RowStats& stats) {
    TileSamples tiles[max_tiles];
    for (int k = 0; k < job.tiles; ++k) tiles[k] = tile_samples(job, k, reach > 0, result, map, stats);
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

  TileSamples tile_samples(const TileJob& job, int k, bool ragged, const TileResult& result,
                           const SampleMap& map, RowStats& stats) const {
    const int first = k * tile_pixels;
    TileSamples tile{.x = job.x + k * tile_size, .y = job.y, .sample = job.sample};
    for (int c = 0; c < 3; ++c) {
      tile.radiance[c] = result.radiance[c] + first;
      tile.emitted[c] = result.emitted[c] + first;
    }
    if (ragged) {
      tile.ragged_x = result.x + first;
      tile.ragged_y = result.y + first;
    }
    for (int i = 0; i < tile_pixels; ++i) {
      const auto x = static_cast<int>(result.x[first + i]), y = static_cast<int>(result.y[first + i]);
      const std::uint64_t bit = std::uint64_t{1} << i;
      const bool smooth = (result.edges[k] & bit) == 0;
      const Vec3f radiance = radiance_of(result, first + i);
      if (x < 0 || x >= window_.full_width || y < 0 || y >= window_.full_height) continue;
      if (keeps(x, y, job.sample, radiance, map, stats)) {
        tile.kept |= bit;
        if (!smooth) settle_emission(x, y, job.sample, first + i, result);
      }
      if (smooth && is_finite(radiance)) tile.smooth |= bit;
    }
    return tile;
  }

  /// Puts a better estimate of what the camera sees of lamps in the place of pixel i's.
  void settle_emission(int x, int y, std::uint64_t sample, int i, const TileResult& result) const {
    if (!edge_emission_.known() || !edges_.of_lamp(x, y)) return;
    const Vec3f seen = edge_emission_.at(x, y, sample);
    for (int c = 0; c < 3; ++c) result.radiance[c][i] += seen[c] - result.emitted[c][i];
  }

  Window window_;
  KernelScene scene_;
  bool differences_;  ///< kept by the film
  PixelEdges edges_;  ///< if so
  int edge_samples_;  ///< as in Plan; 1 if not
  EdgeEmission edge_emission_;
  KernelOptions options_;
  RenderTiles render_tiles_;
  TraceLightPaths trace_light_paths_;  ///< or null
  double light_paths_per_pixel_;       ///< of the full image, for each sample
  int bands_;
  std::vector<std::mutex> row_locks_;
  std::vector<Workplace> workplaces_;
  std::vector<float> first_hits_;
  std::vector<std::uint32_t> first_primitives_;
};

class Wavefront final : public PreparedIntegrator {
 public:
  Wavefront(const Scene& scene, const Job& job)
      : scene_(scene),
        plan_(make_plan(scene, job.options, job.window)),
        kernel_(choose_kernel(job.options.isa)),
        triangles_(scene.triangles.size()),
        data_(scene, plan_, job.window.full_width, job.window.full_height, job.threads) {
    if (job.options.max_depth == 1) return;
    if (job.options.lights == LightSampling::automatic && data_.lights.nodes() > 1)
      as_pilot([&] { learn_lights(scene, job); });
    if (traces_light_paths(job.options, plan_)) as_pilot([&] { learn_emission(job); });
    const OpenChoices open{
        .caustics = job.options.caustics == Switch::automatic && traces_light_paths(job.options, plan_),
        .sharing = plan_.suffixes > 0 && job.options.reuse.automatic && job.options.reconstruct != Switch::on,
        .reconstruction =
            job.options.reconstruct == Switch::automatic && keeps_differences(job.options, plan_)};
    if (open.caustics || open.sharing || open.reconstruction) as_pilot([&] { choose_techniques(job, open); });
  }

  BandWork work(const Job& job) const override {
    const auto run = std::make_shared<WavefrontRun>(scene_, kernel_, data_, plan_, job);
    const int top = job.window.y0;
    return {.height = tile_size,
            .overlap = true,
            .splats = traces_light_paths(job.options, plan_),
            .differences = keeps_differences(job.options, plan_),
            .shared = plan_.suffixes > 0,
            .render = [run, top](int y0, int, const SampleRange& samples, const SampleMap& map, Film& film,
                                 RowStats& stats) {
              run->render_band((y0 - top) / tile_size, samples, map, film, stats);
            }};
  }

  /// Instruction sets count rays differently in the last digit, so a near tie may fall either way.
  std::string decisions(const Job& job) const override {
    std::string items = plan_.light_paths ? "; light-paths=on" : "";
    items += plan_.suffixes > 0 ? "; sharing=on" : "; sharing=off";
    if (keeps_differences(job.options, plan_))
      items += fmt::format("; differences=on; edge-samples={}", plan_.edge_samples);
    if (plan_.light_regions > 0) items += "; light-choice=learned";
    return items;
  }

  void describe(const Film& film, RenderStats& stats) const override {
    stats.pilot_seconds = pilot_seconds_;
    stats.isa = kernel_.name;
    stats.kernel = plan_.kernel + image_source(plan_, film.differences().kept());
    stats.skipped = plan_.skipped;
    if (!data_.is_list()) stats.bvh_seconds = tree_stats().seconds;
    stats.accel_summary = accel_summary();
  }

 private:
  /// Adds the time that `decide` takes to that of pilots.
  template <class Decide>
  void as_pilot(Decide decide) {
    const auto begin = std::chrono::steady_clock::now();
    decide();
    pilot_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  /// Learns which lights are seen from where, and makes use of it where that pays.
  void learn_lights(const Scene& scene, const Job& job) {
    LightRegionTable regions(
        try_lights(scene, kernel_, data_, job.window.full_width, job.window.full_height, job.threads),
        data_.lights.power_shares());
    const double gain = regions.gain();
    // rays over a list cost so little that to look up regions takes a fifth of the time
    const double pays = plan_.list ? 2 : 1.2;
    if (gain < pays) return;
    choose_lights_by_regions(plan_, regions.regions(), gain);
    data_.use(std::move(regions), scene);
  }

  /// What pilots render with.
  class PilotJobs {
   public:
    PilotJobs(const Wavefront& wavefront, int threads) : wavefront_(wavefront) {
      for (int i = 0; i < threads; ++i) workplaces_.emplace_back(wavefront.kernel_);
    }
    Pilot pilot(const Job& job) {
      return {job.window.full_width,
              job.window.full_height,
              wavefront_.plan_.list,
              job.threads,
              [this](const KernelOptions& options, const TileJob& tile, TileResult& result) {
                wavefront_.kernel_.render_tiles[wavefront_.plan_.features](wavefront_.data_.view, options,
                                                                           tile, scratch(), result);
              },
              wavefront_.plan_.light_paths_per_pixel};
    }
    LightPathsJob light_paths() {
      return [this](const KernelOptions& options, const LightPathJob& job, const SplatSink& sink) {
        return wavefront_.kernel_.trace_light_paths[wavefront_.plan_.features](wavefront_.data_.view, options,
                                                                               job, scratch(), sink);
      };
    }

   private:
    void* scratch() { return workplaces_[static_cast<std::size_t>(omp_get_thread_num())].scratch.get(); }

    const Wavefront& wavefront_;
    std::vector<Workplace> workplaces_;
  };

  /// Leads light paths to where mirrors and glass are. That many fewer of them are enough.
  void learn_emission(const Job& job) {
    PilotJobs jobs(*this, job.threads);
    const auto useful = [&] {
      return useful_emission(jobs.pilot(job), kernel_options(job.options, plan_, false), jobs.light_paths());
    };
    const std::vector<UsefulEmission> unguided = useful();
    data_.use(EmissionGuide(unguided));
    plan_.light_paths_per_pixel = light_paths_enough(unguided.size(), useful().size());
    if (plan_.light_paths_per_pixel == 1) data_.use(EmissionGuide());
  }

  /// Keeps paths from lights, and shared paths, unless a pilot says that others do better.
  void choose_techniques(const Job& job, const OpenChoices& open) {
    PilotJobs jobs(*this, job.threads);
    const Gains gains =
        find_gains(jobs.pilot(job), kernel_options(job.options, plan_, false), open, jobs.light_paths());
    if (gains.light_paths) choose_caustics(plan_, *gains.light_paths);
    const bool by_lights = traces_light_paths(job.options, plan_);
    if (open.reconstruction)
      choose_reconstruction(plan_,
                            by_lights ? gains.reconstruction_by_lights : gains.reconstruction_by_chance);
    const std::optional<double>& sharing = by_lights ? gains.sharing_by_lights : gains.sharing_by_chance;
    if (open.sharing && sharing) choose_by_pilot(plan_, *sharing, gains.sharing_error);
  }

  const BvhStats& tree_stats() const { return data_.bvh ? data_.bvh->stats() : data_.instances->stats(); }

  std::string accel_summary() const {
    if (data_.is_list())
      return fmt::format("list: {} triangles as {} facets", triangles_, data_.facets.facets.size());
    return fmt::format("{}, build {}", to_string(tree_stats()), name_of(plan_.build));
  }

  const Scene& scene_;
  Plan plan_;
  const KernelApi& kernel_;
  std::size_t triangles_;
  KernelSceneData data_;
  double pilot_seconds_ = 0;
};

}  // namespace

std::unique_ptr<const PreparedIntegrator> prepare_wavefront(const Scene& scene, const Job& job) {
  return std::make_unique<Wavefront>(scene, job);
}

}  // namespace castray
