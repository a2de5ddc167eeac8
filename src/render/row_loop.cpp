#include "render/row_loop.h"

#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <exception>
#include <mutex>
#include <tuple>

#include "castray/error.h"

namespace castray {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t samples_of_a_pass = 1u << 24;  ///< of the whole window: some seconds of work
constexpr std::uint64_t longest_pass = 64;             ///< samples per pixel
constexpr std::size_t reported_nonfinite = 8;
constexpr double seconds_between_reports = 0.1;

/// The sample counts at which passes end: 1, 2, 4, ... up to the longest pass, then its multiples, and the
/// last sample.
class Passes {
 public:
  Passes(std::uint64_t samples, std::uint64_t pixels) : samples_(samples) {
    while (longest_ > 1 && longest_ * pixels > samples_of_a_pass) longest_ /= 2;
  }

  /// The first end that is at least n, 1 <= n <= all samples.
  std::uint64_t end_from(std::uint64_t n) const {
    return std::min(samples_, n <= longest_ ? std::bit_ceil(n) : (n + longest_ - 1) / longest_ * longest_);
  }

 private:
  std::uint64_t samples_, longest_ = longest_pass;
};

/// How many samples each row of an earlier run has: each row was left at the end of a pass or of the run.
/// Some of its pixels may have less, where samples were not finite.
std::vector<std::uint64_t> finished_samples(const Film& film, const Passes& passes) {
  std::vector<std::uint64_t> finished;
  const Window& w = film.window();
  for (int y = w.y0; y < w.y1; ++y) {
    std::uint64_t most = 0;
    for (int x = w.x0; x < w.x1; ++x) most = std::max<std::uint64_t>(most, film.count(x, y));
    finished.push_back(most == 0 ? 0 : passes.end_from(most));
    if (!film.samples.empty() && most <= film.samples[0].count)
      finished.back() = std::min(finished.back(), film.samples[0].count);
  }
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

/// What keeps `start` from being continued as `film`, to the samples `wanted`; empty where it can be.
std::string difference_to_resume(const Film& start, const Film& film, const SampleRange& wanted) {
  if (start.key != film.key) return difference_of_keys(start.key, film.key);
  if (start.window() != film.window()) return "another crop";
  if (start.scale() != film.scale()) return "the scene's lights were of another brightness";
  if (start.samples.empty()) return "";
  const SampleRange& held = start.samples.front();
  if (start.samples.size() == 1 && held.first == wanted.first && held.count <= wanted.count) return "";
  return fmt::format("its samples begin with {}:{}, and {}:{} are asked for", held.first, held.count,
                     wanted.first, wanted.count);
}

/// The state of one run, shared by its threads.
class RowLoop {
 public:
  RowLoop(const Job& job, const ProgressCallback& progress, const Film* start, const SampleMap& map)
      : time_limit_(job.options.time_limit),
        progress_(progress),
        map_(map),
        window_(job.window),
        samples_(map.range()),
        passes_(samples_.count,
                static_cast<std::uint64_t>(window_.width()) * static_cast<std::uint64_t>(window_.height())) {
    result_.film = Film(window_, job.brightest);
    result_.film.key = job.key;
    finished_.resize(static_cast<std::size_t>(window_.height()));
    if (start) resume(*start);
    result_.stats.threads = job.threads;
    for (int y = window_.y0; y < window_.y1; ++y)
      paths_ += map_.total(y, y + 1, {samples_.first, *row_of(y)});
    paths_before_ = paths_;
  }

  RenderResult run(const BandWork& work) {
    begin_ = Clock::now();
    for (std::uint64_t end = 0; end < samples_.count;) {
      end = passes_.end_from(end + 1);
      run_pass(end, work);
      note_samples();
      if (!stopped_) report(&result_.film);
      if (stopped_) break;
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

  void resume(const Film& start) {
    Film& film = result_.film;
    if (const std::string difference = difference_to_resume(start, film, samples_); !difference.empty())
      throw InputError("the film to resume is of another render: " + difference +
                       "; remove it or give the same options");
    film = start;
    finished_ = finished_samples(film, passes_);
  }

  /// Brings every row to `end` samples.
  void run_pass(std::uint64_t end, const BandWork& work) {
    const int bands = (window_.height() + work.height - 1) / work.height + (work.overlap ? 1 : 0);
    const std::uint64_t begin = finished_.front();  // of all rows, where bands overlap
    ExceptionKeeper keeper;
#pragma omp parallel for schedule(dynamic, 1) num_threads(result_.stats.threads)
    for (int band = 0; band < bands; ++band)
      if (!keeper.any()) keeper.run([&] { run_band(band, begin, end, work); });
    keeper.rethrow();
    if (work.overlap) std::fill(finished_.begin(), finished_.end(), std::max(begin, end));
  }

  void run_band(int band, std::uint64_t begin, std::uint64_t end, const BandWork& work) {
    const int y0 = window_.y0 + band * work.height, y1 = std::min(y0 + work.height, window_.y1);
    const std::uint64_t done = work.overlap ? begin : *row_of(y0);
    if (done >= end || (stopped_ && !work.overlap)) return;
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
    if (time_limit_ && now >= *time_limit_) stop(Stopped::time_limit);
    if (!progress_ || (!film && now < last_report_ + seconds_between_reports)) return;
    last_report_ = now;
    const std::uint64_t paths = paths_;
    const double fraction = static_cast<double>(paths) / static_cast<double>(all_);
    if (!progress_({.fraction = fraction, .paths = paths - paths_before_, .film = film}))
      stop(Stopped::interrupted);
  }

  void stop(Stopped reason) {
    if (!stopped_) reason_ = reason;
    stopped_ = true;
  }

  /// The film holds the samples up to the end of the furthest row.
  void note_samples() {
    const std::uint64_t most = *std::max_element(finished_.begin(), finished_.end());
    result_.film.samples.clear();
    if (most > 0) result_.film.samples.push_back({samples_.first, most});
  }

  std::optional<double> time_limit_;  ///< seconds
  const ProgressCallback& progress_;
  const SampleMap& map_;
  Window window_;
  SampleRange samples_;
  std::uint64_t all_ = map_.total();  ///< paths
  Passes passes_;
  RenderResult result_;
  std::vector<std::uint64_t> finished_;  ///< samples of each row, counted from the first
  Clock::time_point begin_;
  double last_report_ = 0;
  std::atomic<std::uint64_t> paths_ = 0;
  std::uint64_t paths_before_ = 0;  ///< of the film that was resumed
  RowStats totals_;
  std::mutex mutex_, reporting_;
  std::atomic<bool> stopped_ = false;
  Stopped reason_ = Stopped::done;
};

}  // namespace

RenderResult run_rows(const Job& job, const ProgressCallback& progress, const Film* start,
                      const SampleMap& map, const BandWork& work) {
  return RowLoop(job, progress, start, map).run(work);
}

void add_stats(RenderStats& sum, const RenderStats& earlier) {
  sum.render_seconds += earlier.render_seconds;
  sum.paths += earlier.paths;
  sum.rays += earlier.rays;
  sum.nonfinite.insert(sum.nonfinite.begin(), earlier.nonfinite.begin(), earlier.nonfinite.end());
}

}  // namespace castray
