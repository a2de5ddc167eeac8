#include "plan/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "castray/error.h"
#include "core/threads.h"
#include "materials/brightest_emission.h"
#include "plan/film_key.h"

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
void check_target(const RenderOptions& o, Fault fault) {
  if (!o.target_error) return;
  require(!o.samples, "--target-error: cannot go with --samples; leave one out");
  require(fault == Fault::none, "--target-error: cannot go with --fault; give --spp");
}

/// Reconstruction is of shared paths.
void check_reconstruction(const RenderOptions& o) {
  require(!o.edge_samples || (*o.edge_samples >= 1 && *o.edge_samples <= most_edge_samples),
          fmt::format("--edge-samples {}: must be auto or between 1 and {}", o.edge_samples.value_or(0),
                      most_edge_samples));
  require(!o.edge_samples || o.reconstruct != Switch::off,
          "--edge-samples: is for images from differences; leave out --reconstruct off");
  if (o.reconstruct != Switch::on && !o.edge_samples) return;
  const std::string flag = o.reconstruct == Switch::on ? "--reconstruct on" : "--edge-samples";
  require(o.reuse.automatic || o.reuse.width > 0,
          flag + ": needs paths that pixels share; leave out --reuse off");
}

/// What castRay does not have is refused, never ignored.
void check_reference(const RenderOptions& o) {
  const bool by_epsilon = o.integrator == Integrator::automatic;
  const std::string reference =
      "the reference integrator" +
      (by_epsilon ? fmt::format(", which --epsilon {} asks for,", o.epsilon.value_or(0)) : std::string());
  const std::string leave = by_epsilon ? "; leave one out" : "; leave it at auto";
  require(o.lights == LightSampling::automatic || o.lights == LightSampling::area,
          "--lights: " + reference + " samples lights by area only" + leave);
  require(o.reuse.automatic || o.reuse.width == 0,
          "--reuse: " + reference + " shares no paths" + leave + (by_epsilon ? "" : " or off"));
  require(o.caustics != Switch::on, "--caustics on: " + reference + " has no paths from lights" + leave);
  require(o.reconstruct != Switch::on, "--reconstruct on: " + reference + " shares no paths" + leave);
  require(!o.edge_samples, "--edge-samples: " + reference + " shares no paths" + leave);
  require(!o.camera, reference + " shows no other view of a prepared scene; prepare it anew");
  require(o.isa == "auto" || o.isa == "scalar",
          "--isa " + o.isa + ": " + reference + " has no vector kernels" + leave);
}

void check_wavefront(const RenderOptions& o, Fault fault) {
  require(fault == Fault::none, "--fault: only the reference shows the faults; add --integrator reference");
  require(o.precision == Precision::float32,
          "--precision double: only the reference; add --integrator reference");
  require(!o.epsilon,
          fmt::format("--epsilon {}: only the reference integrator has an absolute epsilon, not --integrator "
                      "wavefront; leave one out",
                      o.epsilon.value_or(0)));
  require(o.caustics != Switch::on || (o.jitter && !o.clamp_indirect),
          "--caustics on: paths from lights know neither --jitter off nor --clamp-indirect; leave one out");
  const Reuse& r = o.reuse;
  require(r.automatic || r.width == 0 ||
              (r.width == 8 && r.height == 8 && r.suffixes >= 1 && r.suffixes <= 64 &&
               (r.suffixes & (r.suffixes - 1)) == 0),
          fmt::format("--reuse {}x{}:{}: tiles are 8x8, with a power of two of suffixes up to 64", r.width,
                      r.height, r.suffixes));
}

/// Decides what `automatic` leaves open.
Integrator choose_integrator(const RenderOptions& o, Fault fault) {
  if (o.integrator == Integrator::reference || (o.integrator == Integrator::automatic && o.epsilon)) {
    check_reference(o);
    return Integrator::reference;
  }
  check_wavefront(o, fault);
  return Integrator::wavefront;
}

}  // namespace

SceneFacts facts_of(const Scene& scene) {
  return {scene.name,        scene.file.string(),       scene.width,           scene.height,
          scene_hash(scene), brightest_emission(scene), scene.triangles.size()};
}

Window window_of(int scene_width, int scene_height, const RenderOptions& options) {
  const int width = options.width > 0 ? options.width : scene_width;
  const int height = options.height > 0 ? options.height : scene_height;
  Window window{width, height, 0, 0, width, height};
  if (options.crop) {
    window.x0 = options.crop->x0, window.y0 = options.crop->y0;
    window.x1 = options.crop->x1, window.y1 = options.crop->y1;
  }
  return window;
}

Job make_job(const SceneFacts& scene, const RenderOptions& options, Fault fault) {
  Job job;
  job.options = options;
  job.fault = fault;
  job.window = window_of(scene.width, scene.height, options);
  job.samples = options.samples ? *options.samples : SampleRange{0, options.spp};
  check_image(job.window);
  check_samples(job.samples);
  check_numbers(options);
  check_target(options, fault);
  check_reconstruction(options);
  require(scene.triangles > 0, fmt::format("{}: the scene has no triangle", scene.file));
  job.options.integrator = choose_integrator(options, fault);
  job.threads = options.threads > 0 ? options.threads : available_threads();
  job.brightest = scene.brightest;
  job.key = film_key(scene, job);
  return job;
}

}  // namespace castray
