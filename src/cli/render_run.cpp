#include "cli/render_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "castray/error.h"
#include "cli/film_bands.h"
#include "cli/interrupt.h"
#include "cli/phase.h"
#include "cli/render_passes.h"
#include "cli/temporary_folder.h"
#include "core/files.h"
#include "plan/job.h"

namespace castray::cli {

namespace fs = std::filesystem;

namespace {

constexpr double seconds_between_views = 0.5;

double seconds_since(RenderRun::Clock::time_point begin) {
  return std::chrono::duration<double>(RenderRun::Clock::now() - begin).count();
}

RenderOptions first_sample_of(RenderOptions options) {
  options.time_limit.reset();
  options.spp = 1;
  if (options.samples) options.samples->count = 1;
  return options;
}

/// Statistics of two parts of one render, the later one last.
RenderStats sum_of(const RenderStats& earlier, RenderStats later) {
  later.render_seconds += earlier.render_seconds - earlier.pilot_seconds;
  later.paths += earlier.paths;
  later.rays += earlier.rays;
  if (later.nonfinite.empty()) later.nonfinite = earlier.nonfinite;
  return later;
}

}  // namespace

RenderRun::RenderRun(const RenderRequest& request, const RenderReport& report, Clock::time_point begin)
    : request_(request), report_(report), begin_(begin), display_(mode()) {
  if (request.checkpoint)
    checkpoint_.emplace(*request.checkpoint, request.checkpoint_seconds, request.resume);
}

RenderResult RenderRun::run(const Scene& scene) {
  const std::optional<Film> start = checkpoint_ ? checkpoint_->film_to_resume() : std::nullopt;
  catch_interrupts();
  if (start && !request_.quiet)
    fmt::print(stderr, "castray: going on from {}: {} of {} samples per pixel are there\n",
               checkpoint_->file().string(), samples_text(start->samples_per_pixel()), request_.options.spp);
  if (!request_.passes.empty()) passes_ = surface_passes(scene, request_, mode());
  const PreparedScene prepared = prepare_told(scene);
  display_ = ProgressDisplay(mode());
  open_viewers(scene);
  RenderResult result = render_all(prepared, start ? &*start : nullptr);
  view(result.film);
  terminal_.reset();
  display_.finish(result.stats.stopped != Stopped::interrupted);
  if (result.stats.stopped != Stopped::interrupted)
    add_film_passes(passes_, scene, request_, result.film, mode());
  return result;
}

std::string goes_with_no_bands(const RenderRequest& request) {
  if (request.checkpoint) return "--checkpoint";
  if (request.preview_seconds) return "--preview-every";
  if (request.preview_in_terminal) return "--preview";
  if (request.tev) return "--tev";
  if (request.replicates) return "--replicates";
  if (!request.passes.empty()) return "--passes";
  if (request.options.time_limit) return "--time-limit";
  if (request.options.target_error) return "--target-error";
  return std::any_of(request.outputs.begin(), request.outputs.end(), is_film_format) ? "a .film output" : "";
}

RenderResult RenderRun::run_in_bands(const Scene& scene, int band, int margin) {
  catch_interrupts();
  const PreparedScene prepared = prepare_told(scene);
  display_ = ProgressDisplay(mode());
  const Window window = window_of(scene.width, scene.height, request_.options);
  if (!request_.quiet) display_.tell(fmt::format("in bands of {} rows, as memory has no room for all", band));
  RenderResult all;
  const auto rows = [&](int y0, int y1) -> const Film& {
    RenderOptions options = request_.options;
    options.crop = window;
    options.crop->y0 = y0, options.crop->y1 = y1;
    const std::uint64_t nonfinite = all.film.nonfinite_samples;
    all.film = {};  // its memory is needed
    RenderResult result = render(prepared, options, [&](const Progress& p) {
      const double done = y0 - window.y0 + p.fraction * (y1 - y0);
      return watch({done / window.height(), all.stats.paths + p.paths, nullptr});
    });
    if (result.stats.stopped != Stopped::done) throw BandsInterrupted();
    result.stats = sum_of(all.stats, std::move(result.stats));
    all = std::move(result);
    all.film.nonfinite_samples += nonfinite;
    return all.film;
  };
  write_film_in_bands(
      request_.outputs, {window, band, margin, rows}, request_.display,
      [&](const Film& first) { return report_.metadata(first); }, request_.options.threads);
  display_.finish(true);
  return all;
}

ProgressMode RenderRun::mode() const { return request_.quiet ? ProgressMode::off : request_.progress; }

PreparedScene RenderRun::prepare_told(const Scene& scene) const {
  const Phase phase(mode(), fmt::format("preparing {} triangles", scene.triangles.size()));
  return prepare(scene, request_);
}

RenderResult RenderRun::render_all(const PreparedScene& scene, const Film* start) {
  if (request_.options.time_limit) return render_in_time(scene, start);
  const ProgressCallback progress = [this](const Progress& p) { return watch(p); };
  if (request_.replicates) return render_replicates(scene, request_.options, request_.replicates, progress);
  RenderOptions options = request_.options;
  options.whole_passes = request_.checkpoint.has_value();
  return render(scene, options, progress, start);
}

/// The limit is of the whole program. How long it will take to write the outputs is tried with a first film.
RenderResult RenderRun::render_in_time(const PreparedScene& scene, const Film* start) {
  const ProgressCallback progress = [this](const Progress& p) { return watch(p); };
  RenderOptions options = request_.options;
  options.whole_passes = request_.checkpoint.has_value();
  RenderResult first;
  double writing = 0;
  if (!options.target_error) {
    if (!start || start->samples.empty()) {
      first = render(
          scene, first_sample_of(options),
          [&](const Progress& p) {
            return progress({0, p.paths, nullptr});
          },
          start);
      start = &first.film;
    }
    writing = seconds_to_write(*start);
  }
  options.time_limit = std::max(*options.time_limit - seconds_since(begin_) - writing, 1e-9);
  RenderResult result = render(scene, options, progress, start);
  result.stats = sum_of(first.stats, std::move(result.stats));
  return result;
}

double RenderRun::seconds_to_write(const Film& film) const {
  const Clock::time_point begin = Clock::now();
  try {
    const TemporaryFolder folder;
    std::vector<fs::path> trials;
    for (const fs::path& output : request_.outputs)
      trials.push_back(folder.path() / ("trial" + suffix_of(output)));
    write(trials, film);
  } catch (const InputError&) {
    // a full disk may be another one than that of the outputs
  } catch (const fs::filesystem_error&) {
    // no folder for temporary files
  }
  return seconds_since(begin);
}

bool RenderRun::watch(const Progress& progress) {
  display_.update(progress);
  if (progress.film) watch_film(*progress.film);
  return !interrupted();
}

void RenderRun::watch_film(const Film& film) {
  try {
    save_meanwhile(film);
  } catch (const InputError& error) {  // what cannot be written now may be written at the end
    if (!request_.quiet) display_.tell(fmt::format("warning: {}; the render goes on", error.what()));
  }
  if (seconds_since(viewed_) >= seconds_between_views) view(film);
}

void RenderRun::save_meanwhile(const Film& film) {
  const bool requested = snapshot_requested();
  if (checkpoint_ && requested)
    checkpoint_->save(film);
  else if (checkpoint_)
    checkpoint_->save_if_due(film);
  if (requested || is_preview_due()) write_snapshot(film);
  if (requested && !request_.quiet)
    display_.tell(
        fmt::format("snapshot of {} samples per pixel written", samples_text(film.samples_per_pixel())));
}

void RenderRun::write_snapshot(const Film& film) {
  previewed_ = Clock::now();
  std::vector<fs::path> files;
  for (const fs::path& output : request_.outputs)
    if (!is_standard_output(output)) files.push_back(output);
  write(files, film);
  previewed_ = Clock::now();
}

/// The last view of all stays in tev; the terminal's own screen comes back.
void RenderRun::view(const Film& film) {
  if (!terminal_ && !tev_) return;
  const Image image = image_of(film, request_.options.threads);
  if (terminal_) terminal_->show(image);
  if (tev_) tev_->show(image);
  viewed_ = Clock::now();
}

void RenderRun::open_viewers(const Scene& scene) {
  const Window window = window_of(scene.width, scene.height, request_.options);
  if (request_.tev)
    tev_ = std::make_unique<TevViewer>(*request_.tev, scene.name, window.width(), window.height());
  if (request_.preview_in_terminal) terminal_ = std::make_unique<TerminalPreview>(request_.display);
}

bool RenderRun::is_preview_due() const {
  return request_.preview_seconds && seconds_since(previewed_) >= *request_.preview_seconds;
}

void RenderRun::write(const std::vector<fs::path>& outputs, const Film& film) const {
  write_film(outputs, film, request_.display, report_.metadata(film), request_.options.threads, passes_);
}

void RenderRun::save(const Film& film) {
  const Phase phase(mode(), "writing");
  std::optional<InputError> failed;
  try {
    if (checkpoint_) checkpoint_->save(film);
  } catch (const InputError& error) {
    failed = error;
  }
  write(request_.outputs, film);
  if (failed) throw *failed;
}

}  // namespace castray::cli
