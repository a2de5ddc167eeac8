#include "render/row_loop.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <limits>
#include <mutex>
#include <tuple>
#include <utility>

#include "castray/error.h"

namespace castray {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t samples_of_a_pass = 1u << 24;  ///< of the whole window, at most
constexpr double seconds_of_a_pass = 1;
constexpr std::size_t reported_nonfinite = 8;
constexpr double seconds_between_reports = 0.1;

/// How many samples per pixel the next pass gets: twice as many as the one before, as far as that takes about
/// a second.
class Pace {
 public:
  explicit Pace(std::uint64_t pixels) : longest_(std::max<std::uint64_t>(samples_of_a_pass / pixels, 1)) {}

  /// At least 1.
  std::uint64_t samples_within(double seconds) const {
    std::uint64_t samples = std::min(2 * last_, longest_);
    const double most = std::min(seconds, seconds_of_a_pass) / seconds_per_sample_;
    if (most < static_cast<double>(samples)) samples = static_cast<std::uint64_t>(std::max(most, 0.0));
    return std::max<std::uint64_t>(samples, 1);
  }

  void note_pass(std::uint64_t samples, double seconds) {
    last_ = samples;
    seconds_per_sample_ = seconds / static_cast<double>(samples);
  }
  double seconds_per_sample() const { return seconds_per_sample_; }

 private:
  std::uint64_t longest_, last_ = 0;
  double seconds_per_sample_ = 0;
};

/// How many samples each row of an earlier run has: each was left at the end of a pass. Some of its pixels
/// may have less, where samples were not finite. Throws InputError where others are missing.
std::vector<std::uint64_t> finished_samples(const Film& film) {
  std::vector<std::uint64_t> finished;
  const Window& w = film.window();
  std::uint64_t missing = 0;
  for (int y = w.y0; y < w.y1; ++y) {
    std::uint64_t most = 0, sum = 0;
    for (int x = w.x0; x < w.x1; ++x) {
      most = std::max<std::uint64_t>(most, film.count(x, y));
      sum += film.count(x, y);
    }
    finished.push_back(most);
    missing += most * static_cast<std::uint64_t>(w.width()) - sum;
  }
  if (missing != film.nonfinite_samples)
    throw InputError(
        "the film to resume was stopped within a pass; only films of --checkpoint go on to the same bytes");
  return finished;
}

/// Runs code in threads that no exception may leave, and keeps the first one for the thread that waits.
class ExceptionKeeper {
 public:
  template <class Work>
  void run(Work work) noexcept {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!first_) first_ = std::current_exception();
      any_ = true;
    }
  }
  bool any() const { return any_; }
  void rethrow() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr first_;
  std::atomic<bool> any_ = false;
};

/// The state of one run, shared by its threads.
class RowLoop {
 public:
  RowLoop(const Job& job, const ProgressCallback& progress, const Film* start, const SampleMap& map,
          bool differences)
      : time_limit_(job.options.time_limit.value_or(std::numeric_limits<double>::infinity())),
        whole_passes_(job.options.whole_passes),
        progress_(progress),
        map_(map),
        window_(job.window),
        samples_(map.range()),
        pace_(static_cast<std::uint64_t>(window_.width()) * static_cast<std::uint64_t>(window_.height())) {
    result_.film = Film(window_, job.brightest);
    result_.film.key = job.key;
    result_.film.planned = job.options.planned;
    finished_.resize(static_cast<std::size_t>(window_.height()));
    if (differences) result_.film.keep_differences();
    if (start) resume(*start);
    result_.stats.threads = job.threads;
    for (int y = window_.y0; y < window_.y1; ++y)
      paths_ += map_.total(y, y + 1, {samples_.first, *row_of(y)});
    paths_before_ = paths_;
  }

  RenderResult run(const BandWork& work) {
    begin_ = Clock::now();
    if (work.splats) result_.film.keep_splats();
    while (!stopped_ && least_finished() < samples_.count) {
      run_pass(end_of_next_pass(), work);
      result_.film.add_light_paths(std::exchange(light_paths_, 0));
      note_samples();
      if (!stopped_) report(&result_.film);
      if (!stopped_ && whole_passes_ && seconds() + pace_.seconds_per_sample() > time_limit_)
        stop(Stopped::time_limit);
    }
    RenderStats& stats = result_.stats;
    stats.render_seconds = seconds();
    stats.paths = paths_ - paths_before_;
    stats.rays = totals_.rays;
    stats.nonfinite = totals_.nonfinite;
    stats.stopped = paths_ == all_ ? Stopped::done : reason_;
    return std::move(result_);
  }

 private:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  /// How `start` differs from a film that this render may continue; empty if it does not.
  std::string difference_to_resume(const Film& start) const {
    if (const std::string difference = start.difference_from(result_.film); !difference.empty())
      return difference;
    if (start.window() != window_) return "another crop";
    for (const SampleRange& have : start.samples)
      if (have.first != samples_.first || have.count > samples_.count)
        return fmt::format("its samples are {}:{}, and {}:{} are asked for", have.first, have.count,
                           samples_.first, samples_.count);
    return {};
  }

  void resume(const Film& start) {
    if (const std::string difference = difference_to_resume(start); !difference.empty())
      throw InputError("the film to resume is of another render: " + difference +
                       "; remove it or give the same options");
    const auto planned = result_.film.planned;
    result_.film = start;
    result_.film.planned = planned;
    finished_ = finished_samples(start);
  }

  std::uint64_t least_finished() const { return *std::min_element(finished_.begin(), finished_.end()); }
  std::uint64_t most_finished() const { return *std::max_element(finished_.begin(), finished_.end()); }

  /// Rows that an earlier run left behind catch up first.
  std::uint64_t end_of_next_pass() const {
    const std::uint64_t done = least_finished(), most = most_finished();
    if (most > done) return most;
    return done + std::min(samples_.count - done, pace_.samples_within(time_limit_ - seconds()));
  }

  /// Brings every row to `end` samples.
  void run_pass(std::uint64_t end, const BandWork& work) {
    const int bands = (window_.height() + work.height - 1) / work.height + (work.overlap ? 1 : 0);
    const std::uint64_t begin = least_finished();
    if (work.overlap && most_finished() > begin)
      throw InputError("the film to resume was stopped within a pass of shared paths; render anew");
    const double start = seconds();
    ExceptionKeeper keeper;
#pragma omp parallel for schedule(dynamic, 1) num_threads(result_.stats.threads)
    for (int band = 0; band < bands; ++band)
      if (!keeper.any()) keeper.run([&] { run_band(band, begin, end, work); });
    keeper.rethrow();
    if (work.overlap) std::fill(finished_.begin(), finished_.end(), end);
    pace_.note_pass(end - begin, seconds() - start);
  }

  /// Whether the bands of the pass that are not in work are left out. At the time limit the first pass goes
  /// on, so that the image has no gaps.
  bool breaks_off(std::uint64_t begin, const BandWork& work) const {
    return stopped_ && !(work.overlap && whole_passes_) && (begin > 0 || reason_ == Stopped::interrupted);
  }

  void run_band(int band, std::uint64_t begin, std::uint64_t end, const BandWork& work) {
    const int y0 = window_.y0 + band * work.height, y1 = std::min(y0 + work.height, window_.y1);
    const std::uint64_t done = work.overlap ? begin : *row_of(y0);
    if (done >= end || breaks_off(begin, work)) return;
    RowStats stats;
    const SampleRange samples{samples_.first + done, end - done};
    work.render(y0, y1, samples, map_, result_.film, stats);
    if (!work.overlap) std::fill(row_of(y0), row_of(y1), end);
    paths_ += map_.total(y0, y1, samples);
    add(stats);
    report(nullptr);
  }

  std::vector<std::uint64_t>::iterator row_of(int y) { return finished_.begin() + (y - window_.y0); }

  void add(const RowStats& stats) {
    const std::lock_guard lock(mutex_);
    totals_.rays += stats.rays;
    light_paths_ += stats.light_paths;
    result_.film.nonfinite_samples += stats.nonfinite.size();
    auto& first = totals_.nonfinite;
    first.insert(first.end(), stats.nonfinite.begin(), stats.nonfinite.end());
    std::sort(first.begin(), first.end(), [](const NonfiniteSample& a, const NonfiniteSample& b) {
      return std::tie(a.y, a.x, a.sample) < std::tie(b.y, b.x, b.sample);
    });
    if (first.size() > reported_nonfinite) first.resize(reported_nonfinite);
  }

  /// Reports to the caller, unless that was done just now or another thread is doing it. `film`: null while
  /// rows are in work.
  void report(const Film* film) {
    const std::unique_lock lock(reporting_, std::try_to_lock);
    if (!lock) return;
    const double now = seconds();
    if (now >= time_limit_) stop(Stopped::time_limit);
    if (!progress_ || (!film && now < last_report_ + seconds_between_reports)) return;
    last_report_ = now;
    const std::uint64_t paths = paths_;
    const double fraction =
        std::max(static_cast<double>(paths) / static_cast<double>(all_), std::min(now / time_limit_, 1.0));
    if (!progress_({.fraction = fraction, .paths = paths - paths_before_, .film = film}))
      stop(Stopped::interrupted);
  }

  void stop(Stopped reason) {
    if (!stopped_) reason_ = reason;
    stopped_ = true;
  }

  /// The film holds the samples up to the end of the furthest row.
  void note_samples() {
    const std::uint64_t most = most_finished();
    result_.film.samples.clear();
    if (most > 0) result_.film.samples.push_back({samples_.first, most});
  }

  double time_limit_;  ///< seconds
  bool whole_passes_;
  const ProgressCallback& progress_;
  const SampleMap& map_;
  Window window_;
  SampleRange samples_;
  std::uint64_t all_ = map_.total();  ///< paths
  Pace pace_;
  RenderResult result_;
  std::vector<std::uint64_t> finished_;  ///< samples of each row, counted from the first
  Clock::time_point begin_;
  double last_report_ = 0;
  std::atomic<std::uint64_t> paths_ = 0;
  std::uint64_t paths_before_ = 0;  ///< of the film that was resumed
  RowStats totals_;
  std::uint64_t light_paths_ = 0;  ///< of this pass
  std::mutex mutex_, reporting_;
  std::atomic<bool> stopped_ = false;
  Stopped reason_ = Stopped::done;
};

}  // namespace

RenderResult run_rows(const Job& job, const ProgressCallback& progress, const Film* start,
                      const SampleMap& map, const BandWork& work) {
  return RowLoop(job, progress, start, map, work.differences).run(work);
}

void add_stats(RenderStats& sum, const RenderStats& earlier) {
  sum.render_seconds += earlier.render_seconds;
  sum.paths += earlier.paths;
  sum.rays += earlier.rays;
  sum.nonfinite.insert(sum.nonfinite.begin(), earlier.nonfinite.begin(), earlier.nonfinite.end());
}

}  // namespace castray
