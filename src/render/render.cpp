#include "castray/render.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "castray/error.h"
#include "reference/reference.h"
#include "render/row_loop.h"
#include "wavefront/wavefront.h"

namespace castray {

namespace {

void require(bool condition, const std::string& message) {
  if (!condition) throw InputError(message);
}

void check_image(const Window& w) {
  require(w.full_width >= 1 && w.full_height >= 1 && w.full_width <= max_image_side &&
              w.full_height <= max_image_side &&
              static_cast<long long>(w.full_width) * w.full_height <= max_image_pixels,
          fmt::format("--size {}x{}: each side must be between 1 and {}, and {} pixels in all at most",
                      w.full_width, w.full_height, max_image_side, max_image_pixels));
  require(
      0 <= w.x0 && w.x0 < w.x1 && w.x1 <= w.full_width && 0 <= w.y0 && w.y0 < w.y1 && w.y1 <= w.full_height,
      fmt::format("--crop {},{},{},{}: must be X0,Y0,X1,Y1 with 0 <= X0 < X1 <= {} and 0 <= Y0 < Y1 <= {}",
                  w.x0, w.y0, w.x1, w.y1, w.full_width, w.full_height));
}

void check_samples(const SampleRange& samples) {
  constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  require(samples.count >= 1 && samples.count <= most,
          fmt::format("{} samples per pixel: must be between 1 and {}", samples.count, most));
  require(samples.first <= std::numeric_limits<std::uint64_t>::max() - samples.count,
          fmt::format("--samples {}:{}: the last index is beyond 2^64", samples.first, samples.count));
}

void check_numbers(const RenderOptions& o) {
  const auto positive = [](const char* flag, const std::optional<double>& value) {
    require(!value || (std::isfinite(*value) && *value > 0),
            fmt::format("--{} {}: must be a number above 0", flag, value.value_or(0)));
  };
  require(!o.rr || (*o.rr > 0 && *o.rr <= 1),
          fmt::format("--rr {}: must be auto or in (0,1]", o.rr.value_or(0)));
  require(o.max_depth >= 0, "--max-depth: must be none or at least 1");
  require(o.threads >= 0 && o.threads <= 4096,
          fmt::format("--threads {}: must be between 1 and 4096", o.threads));
  positive("epsilon", o.epsilon);
  positive("clamp-indirect", o.clamp_indirect);
  positive("time-limit", o.time_limit);
  positive("target-error", o.target_error);
}

/// A target error decides how many samples there are, and which.
void check_target(const RenderOptions& o, const Film* start) {
  if (!o.target_error) return;
  require(!o.samples, "--target-error: cannot go with --samples; leave one out");
  require(o.fault == Fault::none, "--target-error: cannot go with --fault; give --spp");
  require(!start, "--target-error: cannot go on from an earlier film; leave out the target or the film");
}

/// What castRay does not have is refused, never ignored.
void check_reference(const RenderOptions& o) {
  require(o.lights == LightSampling::automatic || o.lights == LightSampling::area,
          "--lights: the reference integrator samples lights by area only; leave it at auto");
  require(o.reuse.automatic || o.reuse.width == 0,
          "--reuse: the reference integrator shares no paths; leave it at auto or off");
  require(o.isa == "auto" || o.isa == "scalar",
          fmt::format("--isa {}: the reference integrator has no vector kernels; leave it at auto", o.isa));
}

void check_wavefront(const RenderOptions& o) {
  require(o.fault == Fault::none, "--fault: only the reference shows the faults; add --integrator reference");
  require(o.precision == Precision::float32,
          "--precision double: only the reference; add --integrator reference");
  const Reuse& r = o.reuse;
  require(r.automatic || r.width == 0 ||
              (r.width == 8 && r.height == 8 && r.suffixes >= 1 && r.suffixes <= 64 &&
               (r.suffixes & (r.suffixes - 1)) == 0),
          fmt::format("--reuse {}x{}:{}: tiles are 8x8, with a power of two of suffixes up to 64", r.width,
                      r.height, r.suffixes));
}

}  // namespace

RenderResult render(const Scene& scene, const RenderOptions& options, const ProgressCallback& progress,
                    const Film* start) {
  check_image(window_of(scene, options));
  check_samples(samples_of(options));
  check_numbers(options);
  check_target(options, start);
  require(!scene.triangles.empty(), fmt::format("{}: the scene has no triangle", scene.file.string()));
  // the classic epsilon lives in the reference alone
  if (options.integrator == Integrator::wavefront && !options.epsilon) {
    check_wavefront(options);
    return render_wavefront(scene, options, progress, start);
  }
  check_reference(options);
  return render_reference(scene, options, progress, start);
}

}  // namespace castray
