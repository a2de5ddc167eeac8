#include "cli/memory_need.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/film_bands.h"
#include "cli/memory_limit.h"
#include "cli/render_passes.h"
#include "core/threads.h"
#include "plan/job.h"
#include "plan/memory_need.h"
#include "plan/plan.h"

namespace castray::cli {

namespace {

/// How many films like this are there at once, at most.
std::uint64_t films_at_once(const RenderRequest& request, const Film& like) {
  // two of a pilot and one in work; the first films of means stand beside their first samples
  if (request.options.target_error) return like.differences().kept() ? 3 : 5;
  const bool goes_on = request.resume || request.options.time_limit;
  return goes_on || request.replicates ? 2 : 1;
}

Film film_like(const RenderRequest& request, const Plan& plan) {
  Film film({1, 1, 0, 0, 1, 1}, 1);
  const RenderOptions& options = request.options;
  if (plan.light_paths) film.keep_splats();
  if (!request.replicates && options.integrator != Integrator::reference && keeps_differences(options, plan))
    film.keep_differences();
  return film;
}

/// Of all replicates, whose sums are of blocks of pixels.
std::uint64_t bytes_of_replicates(const RenderRequest& request, const Film& like) {
  constexpr std::uint64_t pixels = noise_block * noise_block, counts = 8;
  return request.replicates * (bytes_of_pixel(like) + counts) / pixels + (request.replicates > 0);
}

}  // namespace

int MemoryNeed::margin() const { return like.differences().kept() ? reconstruction_margin : 0; }

std::uint64_t MemoryNeed::film_rows(int count) const {
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(count);
  return films * bytes_of_film(like, pixels) + more_pixel * pixels;
}

std::uint64_t MemoryNeed::rows(int count) const {
  return film_rows(count) + bytes_of_image(like, width, count, threads);
}

std::uint64_t MemoryNeed::in_least_bands() const {
  return fixed() + rows(std::min(least_band(margin(), height) + 2 * margin(), height));
}

std::string MemoryNeed::text() const {
  const std::uint64_t film = film_rows(height);
  return fmt::format(
      "{} with the scene read, {} for its tree and lights, {} for threads, {} for the film ({} a pixel), "
      "{} for its image",
      bytes_text(scene), bytes_text(preparation), bytes_text(work), bytes_text(film),
      films * bytes_of_pixel(like) + more_pixel, bytes_text(rows(height) - film));
}

MemoryNeed memory_need(const Scene& scene, const RenderRequest& request) {
  const RenderOptions& options = request.options;
  const Window window = window_of(scene.width, scene.height, options);
  const Plan plan = make_plan(scene, options, window);
  MemoryNeed need;
  need.scene = bytes_of_program();
  need.preparation = bytes_to_prepare(scene, plan, options.integrator);
  need.threads = options.threads > 0 ? options.threads : available_threads();
  need.work = bytes_of_thread * static_cast<std::uint64_t>(need.threads);
  need.like = film_like(request, plan);
  need.films = films_at_once(request, need.like);
  need.more_pixel = bytes_of_replicates(request, need.like) + bytes_of_pixel(request.passes);
  need.width = window.width();
  need.height = window.height();
  return need;
}

}  // namespace castray::cli
