#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/noise_free.h"
#include "bench/report.h"
#include "castray/error.h"

namespace castray {

struct Rendering {
  Image image;
  double seconds = 0;                     ///< the render alone
  std::optional<double> process_seconds;  ///< of the whole process, if it was one
};

/// A contender has no equal of something in the scene: it is left out there, and the reports say why.
class NoEqual : public InputError {
 public:
  using InputError::InputError;
};

/// Something that renders the scene at hand. `render` throws NoEqual if the scene is not for it, else
/// InputError if it fails.
struct Contender {
  std::string name;
  ContenderKind kind = ContenderKind::configuration;
  std::string detail;
  std::function<Rendering(std::uint64_t spp, std::uint64_t seed)> render;
  /// Runs the whole process and returns its seconds, where `render` does not tell them; empty: not measured.
  std::function<double(std::uint64_t spp, std::uint64_t seed)> process_seconds = {};
};

struct BenchPlan {
  std::vector<std::uint64_t> spp;  ///< budgets in samples per pixel
  std::vector<double> seconds;     ///< budgets in seconds, turned into spp by a first render
  std::uint64_t seeds = 8;         ///< seeds 1 .. seeds are measured
  std::optional<double> equal_seconds;
  std::optional<Window> crop;
};

/// Told before each render: what is about to be rendered, the part of the work done, and the seconds left by
/// what the renders so far took.
struct BenchProgress {
  std::string what;
  double fraction = 0, seconds_left = 0;
};
using BenchProgressCallback = std::function<void(const BenchProgress&)>;

/// Renders everything and fills scene.curves, equal_seconds and crop. The other fields of `scene` are the
/// caller's. Contenders take turns, seed by seed, so that a machine that slows down slows all of them.
void measure(BenchScene& scene, const std::vector<Contender>& contenders, const ReferencePair& reference,
             const PixelMask& mask, const BenchPlan& plan, const BenchProgressCallback& progress = {});

}  // namespace castray
