#include "render/take_samples.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "render/block_noise.h"
#include "render/row_loop.h"

namespace castray {

namespace {

/// Samples per pixel, at least, of each of the two films of a pilot, and of an image, which tell its error.
/// Fewer than four are not reconstructed.
constexpr std::uint64_t fewest_of_means = 2, fewest_to_reconstruct = 4;
/// Where means need fewer samples than this, the longer pilots of reconstruction take what it gains.
constexpr std::uint64_t enough_to_reconstruct = 40;
/// A pilot aims at one sample for every 8 of the image, and is long enough with one for every 16.
constexpr std::uint64_t share_aimed_at = 8, share_needed = 16;
/// The next pilot has at most this many times the samples of a block: a short pilot's estimate is unreliable.
constexpr std::uint64_t fastest_growth = 8;
constexpr std::uint64_t last_round = 15;
/// The image's error may exceed the target by this factor: it is measured, and has noise of its own.
constexpr double near_enough = 1.4;
/// Pilots use the last replicates of 32-bit sample indices, which no image reaches.
constexpr std::uint64_t last_replicate = (std::uint64_t{1} << 32) / replicate_length - 1;
constexpr std::uint64_t most_of_image = (last_replicate - 2 * last_round - 1) * replicate_length;

/// How samples are taken.
struct Technique {
  Technique(Job of, const PreparedIntegrator& integrator) : job(std::move(of)), work(integrator.work(job)) {
    job.key += integrator.decisions(job);
  }
  Technique(const Technique&) = delete;
  Technique& operator=(const Technique&) = delete;

  Job job;
  BandWork work;  ///< of the job here
};

Job with_means(Job job) {
  job.options.reconstruct = Switch::off;
  return job;
}

class TargetRun {
 public:
  TargetRun(const Job& job, const ProgressCallback& progress, const PreparedIntegrator& integrator)
      : job_(job),
        target_(*job.options.target_error),
        progress_(progress),
        integrator_(integrator),
        technique_(std::make_unique<Technique>(job.options.reconstruct == Switch::on ? job : with_means(job),
                                               integrator)),
        may_reconstruct_(job.options.reconstruct == Switch::automatic) {}

  RenderResult run() {
    SampleMap pilot(job_.window, {0, fewest()});
    planned_ = 2 * share_aimed_at * pilot.total();
    bool whole = reconstructs() ? render_pilot(pilot, 0) : render_two_samples();
    std::optional<BlockNoise> shorter;
    for (std::uint64_t round = 1;; ++round) {
      if (!whole) return pilots_as_image();
      const PixelNoise pixels(pilots_[0], pilots_[1], job_.threads);
      BlockNoise noise(pixels, pilot);
      noise.set_fall(shorter ? noise.fall_from(*shorter) : first_fall_);
      const SampleMap plan = noise.plan(target_, 2 * fewest(), std::min(job_.options.spp, most_of_image));
      planned_ = stats_.paths + plan.total();
      const bool begins_anew = reconstruct_if_it_pays(plan);
      const bool is_long_enough = stats_.paths * share_needed >= plan.total() || round > last_round;
      if (is_long_enough && !begins_anew) return image(pixels, plan);
      shorter = begins_anew ? std::nullopt : std::optional(noise);
      pilot = longer_pilot(pilot, plan);
      planned_ += 2 * pilot.total();
      whole = render_pilot(pilot, round);
    }
  }

 private:
  /// Renders the samples of one map in the time that is left, and adds up the statistics.
  RenderResult render(const SampleMap& map) {
    Job job = technique_->job;
    if (job.options.time_limit) *job.options.time_limit -= stats_.render_seconds;
    const std::uint64_t before = stats_.paths, pilot_paths = stats_.pilot_paths;
    RenderResult result = run_rows(
        job,
        [&](const Progress& p) {
          const std::uint64_t paths = before + p.paths;
          const double fraction = static_cast<double>(paths) / static_cast<double>(planned_);
          return !progress_ || progress_({std::min(fraction, 1.0), paths, p.film});
        },
        nullptr, map, technique_->work);
    add_stats(result.stats, stats_);
    result.stats.pilot_paths = pilot_paths;
    stats_ = result.stats;
    return result;
  }

  /// The two films of a pilot; whether they came to their end.
  bool render_pilot(SampleMap pilot, std::uint64_t round) {
    for (std::uint64_t side = 0; side < 2; ++side) {
      pilot.set_first(first_of_pilot(round, side));
      pilots_[side] = render(pilot).film;
      stats_.pilot_paths = stats_.paths;
      if (stats_.stopped != Stopped::done) return false;
    }
    return true;
  }

  bool reconstructs() const { return technique_->work.differences; }
  std::uint64_t fewest() const { return reconstructs() ? fewest_to_reconstruct : fewest_of_means; }

  /// Goes on with films that keep differences, if means need so many samples that it pays, or as many as
  /// there may be, and the integrator keeps them.
  bool reconstruct_if_it_pays(const SampleMap& plan) {
    const std::uint64_t pixels = SampleMap(job_.window, {0, 1}).total(), most = job_.options.spp;
    if (!may_reconstruct_ || most < 2 * fewest_to_reconstruct ||
        plan.total() < std::min(enough_to_reconstruct, most) * pixels)
      return false;
    may_reconstruct_ = false;
    auto technique = std::make_unique<Technique>(job_, integrator_);
    if (!technique->work.differences) return false;
    technique_ = std::move(technique);
    pilots_[1] = Film();  // is not merged with films that keep differences
    return true;
  }

  /// The first pilot of means: of two samples, taken one after the other, so that it tells at once how fast
  /// the noise falls. Shared paths gain more by their second sample than by those after it.
  bool render_two_samples() {
    SampleMap one(job_.window, {0, 1});
    if (!render_pilot(one, 0)) return false;
    const std::array<Film, 2> first{pilots_[0], pilots_[1]};
    for (std::uint64_t side = 0; side < 2; ++side) {
      one.set_first(first_of_pilot(0, side) + 1);
      pilots_[side].merge(render(one).film);
      stats_.pilot_paths = stats_.paths;
      if (stats_.stopped != Stopped::done) return false;
    }
    if (!technique_->work.shared) first_fall_ = fall_from_first(pilots_[0], pilots_[1], first[0], first[1]);
    return true;
  }

  static std::uint64_t first_of_pilot(std::uint64_t round, std::uint64_t side) {
    return (last_replicate - 2 * round - side) * replicate_length;
  }

  SampleMap longer_pilot(const SampleMap& pilot, const SampleMap& plan) const {
    std::vector<std::uint64_t> counts;
    for (std::size_t i = 0; i < plan.blocks(); ++i)
      counts.push_back(std::min({std::max(plan.count(i) / (2 * share_aimed_at), fewest()),
                                 fastest_growth * pilot.count(i), replicate_length}));
    SampleMap longer = pilot;
    longer.set_counts(std::move(counts));
    return longer;
  }

  /// The image of a render that was stopped before the pilots ended.
  RenderResult pilots_as_image() {
    Film& film = pilots_[0];
    if (!pilots_[1].samples.empty()) film.merge(pilots_[1]);
    return {std::move(film), std::move(stats_)};
  }

  /// The image is two films, independent of each other, so that it knows its own error. Only the pilot
  /// decides about samples: an image that is kept or not by the noise seen in it is biased.
  RenderResult image(const PixelNoise& of_pilot, const SampleMap& plan) {
    const std::uint64_t nonfinite = pilots_[0].nonfinite_samples + pilots_[1].nonfinite_samples;
    for (Film& film : pilots_) film = Film();  // its memory is needed
    const auto [first, second] = halves(plan);
    RenderResult result = render(first);
    std::optional<PixelNoise> measured;
    if (result.stats.stopped == Stopped::done && second.total() > 0) {
      RenderResult rest = render(second);
      if (rest.stats.stopped == Stopped::done) measured.emplace(result.film, rest.film, job_.threads);
      result.film.merge(rest.film);
      result.stats = std::move(rest.stats);
    }
    result.stats.expected_error = (measured ? *measured : of_pilot).expected_error(result.film);
    result.film.nonfinite_samples += nonfinite;
    const bool reached = *result.stats.expected_error <= near_enough * target_;
    if (result.stats.stopped == Stopped::done && reached) result.stats.stopped = Stopped::target_error;
    return result;
  }

  /// Half of each block's samples, and the rest in the replicate after it.
  static std::array<SampleMap, 2> halves(const SampleMap& plan) {
    std::array<SampleMap, 2> maps{plan, plan};
    for (std::size_t half = 0; half < 2; ++half) {
      std::vector<std::uint64_t> counts;
      for (std::size_t i = 0; i < plan.blocks(); ++i) counts.push_back((plan.count(i) + 1 - half) / 2);
      maps[half].set_counts(std::move(counts));
      maps[half].set_first(half * replicate_length);
    }
    return maps;
  }

  const Job& job_;
  double target_;  ///< relMSE
  const ProgressCallback& progress_;
  const PreparedIntegrator& integrator_;
  std::unique_ptr<Technique> technique_;
  bool may_reconstruct_;  ///< but does not yet
  Film pilots_[2];
  double first_fall_ = 0;      ///< of the first pilot's noise
  RenderStats stats_;          ///< of all so far
  std::uint64_t planned_ = 0;  ///< paths from the start to the end, as far as is known
};

}  // namespace

RenderResult take_samples(const Job& job, const ProgressCallback& progress, const Film* start,
                          const PreparedIntegrator& integrator) {
  if (job.options.target_error) return TargetRun(job, progress, integrator).run();
  const Technique technique(job, integrator);
  return run_rows(technique.job, progress, start, SampleMap(job.window, job.samples), technique.work);
}

}  // namespace castray
