#include "bench/measure.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/crop.h"
#include "castray/error.h"
#include "castray/metrics.h"

namespace castray {

namespace {

/// A contender's cost, estimated by a first render.
struct Cost {
  double seconds_per_spp = 0;  ///< of the render alone
  double overhead = 0;         ///< per render: start, load, build, write, evaluation of the image

  double of(std::uint64_t spp) const { return overhead + seconds_per_spp * static_cast<double>(spp); }
  std::uint64_t spp_in(double seconds) const {
    return static_cast<std::uint64_t>(std::max(1.0, std::round(seconds / seconds_per_spp)));
  }
};

/// Renders, and keeps the books: errors of the images, time used and left.
class Measurement {
 public:
  Measurement(BenchScene& scene, const std::vector<Contender>& contenders, const ReferencePair& reference,
              const PixelMask& mask, const BenchPlan& plan, const BenchProgressCallback& progress)
      : scene_(scene),
        contenders_(contenders),
        reference_(reference),
        mask_(mask),
        plan_(plan),
        progress_(progress),
        costs_(contenders.size()) {}

  void run() {
    for (const Contender& contender : contenders_)
      scene_.curves.push_back({contender.name, contender.kind, contender.detail, {}, {}, {}, {}});
    for (std::size_t c = 0; c < contenders_.size(); ++c) estimate_cost(c);
    for (std::size_t c = 0; c < contenders_.size(); ++c) choose_budgets(c);
    for (std::uint64_t seed = 1; seed <= plan_.seeds; ++seed) measure_all(seed);
    for (std::size_t c = 0; c < contenders_.size(); ++c) summarize(scene_.curves[c], contenders_[c]);
    scene_.equal_seconds = plan_.equal_seconds.value_or(common_seconds());
    for (std::size_t c = 0; c < contenders_.size(); ++c) measure_equal_time(c);
    scene_.crop = plan_.crop.value_or(worst_window(scene_, mask_));
  }

 private:
  Rendering render(std::size_t c, std::uint64_t spp, std::uint64_t seed) {
    if (progress_) {
      const double left = planned_seconds_ - used_seconds_;
      progress_({fmt::format("{} {}, {} spp, seed {}", scene_.name, contenders_[c].name, spp, seed),
                 planned_seconds_ > 0 ? used_seconds_ / planned_seconds_ : 0, std::max(0.0, left)});
    }
    Rendering rendering = contenders_[c].render(spp, seed);
    if (rendering.image.width != scene_.width || rendering.image.height != scene_.height)
      throw InputError(fmt::format(
          "{}: its image is {}x{}, not {}x{}; pass {{width}} and {{height}} on to it", contenders_[c].name,
          rendering.image.width, rendering.image.height, scene_.width, scene_.height));
    used_seconds_ += costs_[c].of(spp);
    return rendering;
  }

  /// A first render, not counted; it also warms caches up.
  void estimate_cost(std::size_t c) {
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t spp = plan_.spp.empty() ? 1 : *std::min_element(plan_.spp.begin(), plan_.spp.end());
    try {
      const Rendering rendering = render(c, spp, 0);
      const std::chrono::duration<double> all = std::chrono::steady_clock::now() - start;
      costs_[c].seconds_per_spp = std::max(rendering.seconds, 1e-6) / static_cast<double>(spp);
      costs_[c].overhead = std::max(0.0, all.count() - rendering.seconds);
    } catch (const NoEqual& error) {
      scene_.curves[c].failure = error.what();
    } catch (const InputError& error) {
      if (contenders_[c].kind != ContenderKind::ablation) throw;
      scene_.curves[c].failure = error.what();
    }
  }

  void choose_budgets(std::size_t c) {
    if (!scene_.curves[c].failure.empty()) return;
    std::vector<std::uint64_t> budgets = plan_.spp;
    for (const double seconds : plan_.seconds) budgets.push_back(costs_[c].spp_in(seconds));
    std::sort(budgets.begin(), budgets.end());
    budgets.erase(std::unique(budgets.begin(), budgets.end()), budgets.end());
    for (const std::uint64_t spp : budgets) {
      scene_.curves[c].points.emplace_back().spp = spp;
      planned_seconds_ += costs_[c].of(spp) * static_cast<double>(plan_.seeds);
    }
    if (contenders_[c].kind != ContenderKind::ablation)
      planned_seconds_ += costs_[c].of(budgets.front());  // about the render at equal time
  }

  void measure_all(std::uint64_t seed) {
    for (std::size_t c = 0; c < contenders_.size(); ++c) {
      for (BenchPoint& point : scene_.curves[c].points) {
        const Rendering rendering = render(c, point.spp, seed);
        const NoiseFreeErrors errors = noise_free_errors(rendering.image, reference_, mask_);
        const NoiseFreeErrors everywhere = noise_free_errors(rendering.image, reference_);
        point.runs.push_back({seed, rendering.seconds, rendering.process_seconds, errors.relmse, errors.mse,
                              everywhere.relmse});
      }
    }
  }

  static double median_of(const std::vector<BenchRun>& runs, double BenchRun::*value) {
    std::vector<double> values;
    for (const BenchRun& run : runs) values.push_back(run.*value);
    return median(std::move(values));
  }

  /// Of the whole process of the run whose render took the median time, so that the two belong together.
  static std::optional<double> process_seconds_of_median(BenchPoint& point, const Contender& contender) {
    std::vector<double> seconds;
    for (const BenchRun& run : point.runs) seconds.push_back(run.seconds);
    BenchRun& run = point.runs[median_index(seconds)];
    if (!run.process_seconds && contender.process_seconds)
      run.process_seconds = contender.process_seconds(point.spp, run.seed);
    return run.process_seconds;
  }

  static void summarize(BenchCurve& curve, const Contender& contender) {
    std::vector<TimeAndError> medians;
    for (BenchPoint& point : curve.points) {
      point.seconds = median_of(point.runs, &BenchRun::seconds);
      point.process_seconds = process_seconds_of_median(point, contender);
      point.relmse = median_of(point.runs, &BenchRun::relmse);
      point.mse = median_of(point.runs, &BenchRun::mse);
      point.relmse_everywhere = median_of(point.runs, &BenchRun::relmse_everywhere);
      point.efficiency = efficiency(point.relmse, point.seconds);
      medians.push_back({point.seconds, point.relmse});
    }
    curve.fit = fit_power_law(medians);
  }

  /// The shortest time that gives every configuration and peer at least its smallest budget.
  double common_seconds() const {
    double seconds = 0;
    for (const BenchCurve& curve : scene_.curves)
      if (curve.kind != ContenderKind::ablation && !curve.points.empty())
        seconds = std::max(seconds, curve.points.front().seconds);
    return seconds;
  }

  void measure_equal_time(std::size_t c) {
    BenchCurve& curve = scene_.curves[c];
    if (curve.points.empty() || curve.kind == ContenderKind::ablation) return;
    const BenchPoint& largest = curve.points.back();
    costs_[c].seconds_per_spp = largest.seconds / static_cast<double>(largest.spp);
    const std::uint64_t spp = costs_[c].spp_in(scene_.equal_seconds);
    Rendering rendering = render(c, spp, plan_.seeds + 1);
    const NoiseFreeErrors errors = noise_free_errors(rendering.image, reference_, mask_);
    const double difference = flip(displayed(rendering.image, {}), displayed(scene_.reference_image, {}));
    curve.equal_time =
        EqualTimeRun{spp, rendering.seconds, errors.relmse, difference, std::move(rendering.image)};
  }

  BenchScene& scene_;
  const std::vector<Contender>& contenders_;
  const ReferencePair& reference_;
  const PixelMask& mask_;
  const BenchPlan& plan_;
  const BenchProgressCallback& progress_;
  std::vector<Cost> costs_;
  double planned_seconds_ = 0, used_seconds_ = 0;
};

}  // namespace

void measure(BenchScene& scene, const std::vector<Contender>& contenders, const ReferencePair& reference,
             const PixelMask& mask, const BenchPlan& plan, const BenchProgressCallback& progress) {
  Measurement(scene, contenders, reference, mask, plan, progress).run();
}

}  // namespace castray
