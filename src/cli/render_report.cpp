#include "cli/render_report.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/black_film.h"
#include "cli/display_flags.h"
#include "cli/scene_report.h"
#include "cli/shell_word.h"
#include "plan/job.h"

namespace castray::cli {

namespace {

const char* name_of(Stopped stopped) {
  switch (stopped) {
    case Stopped::time_limit:
      return "time-limit";
    case Stopped::target_error:
      return "target-error";
    case Stopped::interrupted:
      return "interrupted";
    case Stopped::done:
      break;
  }
  return "done";
}

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

double millions_per_second(std::uint64_t count, double seconds) {
  return seconds > 0 ? static_cast<double>(count) * 1e-6 / seconds : 0;
}

/// A whole number where it is one.
nlohmann::json spp_number(const Film& film) {
  const double spp = film.samples_per_pixel();
  return spp == std::floor(spp) ? nlohmann::json(static_cast<std::uint64_t>(spp)) : nlohmann::json(spp);
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Flags that change neither samples nor how they are shown.
const std::set<std::string> no_part_of_the_image = {
    "threads",  "checkpoint", "stats",         "checkpoint-every", "resume", "time-limit",  "progress",
    "metadata", "strict",     "preview-every", "preview",          "tev",    "memory-limit"};

}  // namespace

void RenderReport::print_warnings(bool verbose) const {
  constexpr int most = 20;
  int told = 0, left = 0;
  for (const SceneWarning& warning : scene.warnings) {
    if (warning.harmless && !verbose) continue;
    if (told < most || verbose)
      fmt::print(stderr, "castray: warning: {}\n", warning.text());
    else
      ++left;
    ++told;
  }
  if (left > 0)
    fmt::print(stderr, "castray: {} more warnings: see castray info {}\n", left, scene.file.string());
}

void RenderReport::print_scene(bool verbose) const {
  print_warnings(verbose);
  if (scene.default_environment)
    fmt::print(stderr,
               "castray: nothing in {} emits {}, so a white sky does; --environment R,G,B|FILE|off decides\n",
               scene.file.string(), scene.lights.empty() ? "light" : "more than white");
  else if (is_dark(scene))
    fmt::print(stderr, "castray: warning: {}: {}\n", scene.file.string(), dark_scene);
  if (!verbose) return;
  fmt::print(stderr, "castray: {}: {} triangles, {} of them lights, {} materials; read in {:.3f} s\n",
             scene.file.string(), scene.triangles.size(), scene.lights.size(), scene.materials.size(),
             load_seconds);
  if (!scene.instances.empty() || scene.expanded_instances > 0)
    fmt::print(stderr,
               "castray: {} instances of {} objects show {} triangles; {} became meshes of their own\n",
               scene.instances.size(), scene.shared_meshes.size(), scene.shown_triangles(),
               scene.expanded_instances);
  for (const std::string& key : scene.ignored_keys) fmt::print(stderr, "castray: ignored: {}\n", key);
}

void RenderReport::print_black() const {
  const bool in_bands = result.film.window() != window_of(scene.width, scene.height, options);
  if (in_bands || is_dark(scene) || !is_black(result.film)) return;
  fmt::print(stderr, "castray: warning: the image is black: {}\n", why_black(scene, options));
}

void RenderReport::print_nonfinite() const {
  const RenderStats& stats = result.stats;
  if (stats.nonfinite.empty()) return;
  fmt::print(stderr,
             "castray: warning: {} samples were not finite and were left out; the first, and how to see each "
             "again:\n",
             result.film.nonfinite_samples);
  for (const NonfiniteSample& sample : stats.nonfinite)
    fmt::print(stderr, "  pixel ({},{}), sample {}: {}\n", sample.x, sample.y, sample.sample, replay(sample));
}

void RenderReport::print_summary(const std::vector<std::filesystem::path>& outputs, bool as_asked) const {
  const RenderStats& s = result.stats;
  const Film& film = result.film;
  const Window window = window_of(scene.width, scene.height, options);
  if (s.accel_summary.starts_with("BVH"))
    fmt::print(stderr, "BVH generation complete: {}\n", s.accel_summary);
  fmt::print(stderr, "{}: {} triangles, {} x {} pixels, {} spp; {}{}; {} threads\n", scene.name,
             scene.triangles.size(), window.width(), window.height(), samples_text(film.samples_per_pixel()),
             s.kernel, s.isa == "none" ? "" : " (" + s.isa + ")", s.threads);
  if (options.epsilon && options.integrator == Integrator::automatic)
    fmt::print(stderr,
               "rendered by the reference integrator: only it has an absolute epsilon (--epsilon {:g})\n",
               *options.epsilon);
  if (!s.skipped.empty()) fmt::print(stderr, "not needed: {}\n", joined(s.skipped));
  if (options.clamp_indirect)
    fmt::print(stderr, "biased: --clamp-indirect {:g} loses indirect light\n", *options.clamp_indirect);
  fmt::print(
      stderr,
      "{:.3f} s for the BVH, {:.3f} s to render, {:.2f} Msamples/s, {:.2f} Mrays/s, {:.1f} MiB at most\n",
      s.bvh_seconds, s.render_seconds, millions_per_second(s.paths, s.render_seconds),
      millions_per_second(s.rays, s.render_seconds), static_cast<double>(peak_memory_bytes()) / (1 << 20));
  for (const auto& output : outputs) fmt::print(stderr, "wrote {}\n", output.string());
  if (s.expected_error) print_expected_error();
  if (as_asked)
    fmt::print(stderr, "Render complete\n");
  else if (s.stopped == Stopped::done)
    fmt::print(stderr, "Render stopped short of its target{}; what was rendered is saved\n",
               limited_by_spp() ? " by --spp" : "");
  else
    fmt::print(stderr, "Render stopped early: {}; what was rendered is saved\n", name_of(s.stopped));
}

bool RenderReport::limited_by_spp() const {
  const Window& w = result.film.window();
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x)
      if (result.film.count(x, y) >= options.spp) return true;
  return false;
}

void RenderReport::print_expected_error() const {
  const double target = *options.target_error;
  const Stopped stopped = result.stats.stopped;
  fmt::print(stderr, "relMSE about {:.2g}, ", *result.stats.expected_error);
  if (stopped == Stopped::target_error)
    fmt::print(stderr, "the target was {:.2g}\n", target);
  else
    fmt::print(stderr, "the target of {:.2g} was not reached{}\n", target,
               stopped != Stopped::done ? ""
               : limited_by_spp()       ? "; raise --spp"
                                        : ": bright samples are rarer than the pilot saw; ask for less");
}

std::string RenderReport::json() const {
  const RenderStats& s = result.stats;
  const Window window = window_of(scene.width, scene.height, options);
  nlohmann::ordered_json object = {{"version", CASTRAY_VERSION},
                                   {"scene", scene.file.string()},
                                   {"width", window.width()},
                                   {"height", window.height()},
                                   {"spp", spp_number(result.film)},
                                   {"seed", options.seed},
                                   {"threads", s.threads},
                                   {"isa", s.isa},
                                   {"kernel", s.kernel},
                                   {"skipped", s.skipped},
                                   {"accel", s.accel_summary},
                                   {"triangles", scene.triangles.size()},
                                   {"instances", scene.instances.size()},
                                   {"shown_triangles", scene.shown_triangles()},
                                   {"lights", scene.lights.size()},
                                   {"load_seconds", load_seconds},
                                   {"bvh_seconds", s.bvh_seconds},
                                   {"pilot_seconds", s.pilot_seconds},
                                   {"render_seconds", s.render_seconds},
                                   {"total_seconds", total_seconds},
                                   {"paths", s.paths},
                                   {"rays", s.rays},
                                   {"mpaths_per_second", millions_per_second(s.paths, s.render_seconds)},
                                   {"mrays_per_second", millions_per_second(s.rays, s.render_seconds)},
                                   {"peak_memory_bytes", peak_memory_bytes()},
                                   {"nonfinite_samples", result.film.nonfinite_samples},
                                   {"biased", options.clamp_indirect.has_value()},
                                   {"stopped", name_of(s.stopped)}};
  if (options.target_error)
    object["target_error"] = *options.target_error, object["pilot_paths"] = s.pilot_paths;
  if (s.expected_error) object["expected_error"] = *s.expected_error;
  return object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Metadata RenderReport::metadata(const Film& film) const {
  Metadata metadata = describe(film);
  add_writer(metadata);
  metadata["castray:scene"] = scene.name;
  metadata["castray:options"] += repeating_flags(metadata["castray:options"], film);
  if (tells_time) metadata["castray:seconds"] = fmt::format("{:.3f}", result.stats.render_seconds);
  return metadata;
}

std::string RenderReport::repeating_flags(const std::string& known, const Film& film) const {
  const bool all_samples = !options.samples && !options.target_error;
  std::string flags = all_samples ? fmt::format(" --spp {:.0f}", std::ceil(film.samples_per_pixel())) : "";
  for (const GivenFlag& g : given) {
    const std::string name = g.flag->name;
    if (name == "part") {
      flags += fmt::format(" --samples {}:{}", options.samples->first, options.samples->count);
      continue;
    }
    const bool is_known = (" " + known).find(" --" + name + " ") != std::string::npos;
    if (!is_known && !no_part_of_the_image.contains(name) && !(all_samples && name == "spp"))
      flags += g.text();
  }
  return flags;
}

std::string RenderReport::replay(const NonfiniteSample& sample) const {
  static const std::set<std::string> other_samples = {"spp", "samples", "part", "crop", "target-error"};
  std::string command = "castray render " + shell_word(scene.file.string());
  for (const GivenFlag& g : given)
    if (!no_part_of_the_image.contains(g.flag->name) && !other_samples.contains(g.flag->name))
      command += g.text();
  return command + fmt::format(" --crop {},{},{},{} --samples {}:1 -o sample.pfm", sample.x, sample.y,
                               sample.x + 1, sample.y + 1, sample.sample);
}

}  // namespace castray::cli
