#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/statistics.h"
#include "castray/film.h"
#include "castray/image.h"

namespace castray {

/// One render: its time, and its error free of the references' noise.
struct BenchRun {
  std::uint64_t seed = 0;
  double seconds = 0;                     ///< the render alone
  std::optional<double> process_seconds;  ///< start, load, build, render, write; where it was measured
  double relmse = 0, mse = 0;
  double relmse_everywhere = 0;  ///< also where the camera sees an emitter
};

/// One budget; the numbers are medians over the runs.
struct BenchPoint {
  std::uint64_t spp = 0;
  std::vector<BenchRun> runs;
  double seconds = 0;
  std::optional<double> process_seconds;  ///< of the run of median seconds
  double relmse = 0, mse = 0, relmse_everywhere = 0;
  double efficiency = 0;  ///< 1 / (relmse * seconds)
};

/// One render with the spp that fit the scene's equal time.
struct EqualTimeRun {
  std::uint64_t spp = 0;
  double seconds = 0, relmse = 0, flip = 0;
  Image image;
};

/// What renders: castray as a user configures it, castray with one technique off, or another program.
enum class ContenderKind : std::uint8_t { configuration, ablation, peer };

struct BenchCurve {
  std::string name;
  ContenderKind kind = ContenderKind::configuration;
  std::string detail;  ///< flags, or the peer's command
  std::string
      failure;  ///< why there are no points: the scene does not allow the ablation, or is not for the peer
  std::vector<BenchPoint> points;
  std::optional<PowerLaw> fit;
  std::optional<EqualTimeRun> equal_time;
};

struct BenchScene {
  std::string name, file;
  int width = 0, height = 0;
  std::string reference;       ///< what the references are
  double reference_noise = 0;  ///< relMSE of their mean
  bool masked = false;         ///< pixels that see an emitter, and their neighbours, are left out
  double counted = 1;          ///< share of the pixels that count
  Image reference_image;
  double equal_seconds = 0;
  Window crop;  ///< what the pictures show enlarged
  std::vector<BenchCurve> curves;

  /// Whether an error was measured of which much may be the references' noise: it adds about a tenth of
  /// theirs where rare bright samples are most of it.
  bool needs_better_references() const;
};

struct BenchReport {
  std::string version, machine, command;
  int threads = 0;
  std::uint64_t seeds = 0;
  std::vector<BenchScene> scenes;
};

/// The errors whose times are reported.
inline constexpr double target_errors[] = {1e-2, 1e-3, 1e-4};

/// "configuration", "ablation" or "peer".
std::string kind_name(ContenderKind kind);

/// For people, in columns.
std::string bench_table(const BenchReport& report);
/// One line a point, with a header.
std::string bench_csv(const BenchReport& report);
/// All numbers, also of every run.
std::string bench_json(const BenchReport& report);
/// One page that needs nothing else: plots, pictures at equal time, ablation, tables.
std::string bench_html(const BenchReport& report);
/// The plots of the page as one picture.
std::string bench_svg(const BenchReport& report);

}  // namespace castray
