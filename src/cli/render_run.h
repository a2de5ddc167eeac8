#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "cli/checkpoint.h"
#include "cli/progress.h"
#include "cli/render_flags.h"
#include "cli/render_report.h"
#include "cli/terminal_preview.h"
#include "cli/tev.h"

namespace castray::cli {

/// An interrupt before all rows were there.
struct BandsInterrupted {};

/// A flag of the request that needs the whole film in memory; empty if none does.
std::string goes_with_no_bands(const RenderRequest& request);

/// Renders what is requested: with progress, checkpoints, snapshots of the outputs, and signals answered.
class RenderRun {
 public:
  using Clock = std::chrono::steady_clock;

  /// `report` tells of the scene; `begin` is when the program started, for the time limit.
  RenderRun(const RenderRequest& request, const RenderReport& report, Clock::time_point begin);

  /// Throws PassesInterrupted.
  RenderResult run(const Scene& scene);

  /// Renders so many rows at a time, with a margin above and below of which their image depends, and writes
  /// them to the outputs. The result's film is that of the last rows, with the number of all samples that
  /// were not finite. Throws BandsInterrupted.
  RenderResult run_in_bands(const Scene& scene, int band, int margin);

  /// Writes the film to the checkpoint, then to the outputs: to all that can be written. Throws InputError
  /// where one cannot.
  void save(const Film& film);

 private:
  ProgressMode mode() const;
  PreparedScene prepare_told(const Scene& scene) const;
  RenderResult render_all(const PreparedScene& scene, const Film* start);
  RenderResult render_in_time(const PreparedScene& scene, const Film* start);
  double seconds_to_write(const Film& film) const;

  /// Returns whether the render goes on.
  bool watch(const Progress& progress);
  void watch_film(const Film& film);
  /// Writes the checkpoint and the outputs so far, where they are due or asked for. Throws InputError.
  void save_meanwhile(const Film& film);
  void write_snapshot(const Film& film);
  bool is_preview_due() const;
  void open_viewers(const Scene& scene);
  void view(const Film& film);
  void write(const std::vector<std::filesystem::path>& outputs, const Film& film) const;

  const RenderRequest& request_;
  const RenderReport& report_;
  Clock::time_point begin_, previewed_ = Clock::now(), viewed_;
  Passes passes_;
  std::optional<Checkpoint> checkpoint_;
  ProgressDisplay display_;
  std::unique_ptr<TerminalPreview> terminal_;
  std::unique_ptr<TevViewer> tev_;
};

}  // namespace castray::cli
