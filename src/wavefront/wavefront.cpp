#include "wavefront/wavefront.h"

#include <fmt/format.h>
#include <omp.h>

#include <chrono>
#include <optional>

#include "geometry/build_quality.h"
#include "wavefront/choose_kernel.h"
#include "wavefront/kernel_options.h"
#include "wavefront/learn_emission.h"
#include "wavefront/pilot.h"
#include "wavefront/pilot_branches.h"
#include "wavefront/try_lights.h"
#include "wavefront/wavefront_run.h"

namespace castray {

namespace {

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
            job.options.reconstruct == Switch::automatic && keeps_differences(job.options, plan_),
        .few = plan_.few_suffixes > 0};
    if (open.caustics || open.sharing || open.reconstruction) as_pilot([&] { choose_techniques(job, open); });
    // behind mirrors and glass, whose lobes are narrow, branches find the same again
    const bool specular = plan_.few_suffixes > 0;
    if (open.sharing && plan_.suffixes == 0 && !specular) as_pilot([&] { try_branches(job); });
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
    if (plan_.twice_the_light_paths) items += "; light-path-number=twice";
    items += plan_.suffixes > 0 ? "; sharing=on" : "; sharing=off";
    if (plan_.branches > 1) items += fmt::format("; branches={}", plan_.branches);
    if (plan_.suffixes > 0 && plan_.suffixes == plan_.few_suffixes)
      items += fmt::format("; suffixes={}", plan_.suffixes);
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
              wavefront_.plan_.light_paths_per_pixel,
              wavefront_.plan_.narrow_coats,
              wavefront_.plan_.matte};
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

  /// Leads light paths to where mirrors and glass are: that many fewer of them are enough. And paths from the
  /// camera to where these send the light, unless mirrors show where it comes from.
  void learn_emission(const Job& job) {
    PilotJobs jobs(*this, job.threads);
    const auto focused = [&](bool arrivals) {
      return focused_light(jobs.pilot(job), kernel_options(job.options, plan_, false), arrivals,
                           jobs.light_paths());
    };
    const std::vector<UsefulEmission> unguided = focused(false).emission;
    data_.use(EmissionGuide(unguided));
    FocusedLight guided = focused(data_.mirrored.empty());
    plan_.light_paths_per_pixel = light_paths_enough(unguided.size(), guided.emission.size());
    if (plan_.light_paths_per_pixel == 1) data_.use(EmissionGuide());
    data_.use(ArrivalGuide(std::move(guided.arrivals)));
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
    const bool few = by_lights ? gains.few_by_lights : gains.few_by_chance;
    if (open.sharing && sharing)
      choose_by_pilot(plan_, *sharing, gains.sharing_error, few, gains.by_single_samples);
    const std::optional<double>& twice =
        plan_.suffixes > 0 ? gains.twice_with_shared : gains.twice_with_plain;
    if (by_lights && twice) choose_number_of_light_paths(plan_, *twice);
  }

  void try_branches(const Job& job) {
    PilotJobs jobs(*this, job.threads);
    const BranchGain gain = find_branches(jobs.pilot(job), kernel_options(job.options, plan_, false));
    choose_two_branches(plan_, gain.gain, gain.error);
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
