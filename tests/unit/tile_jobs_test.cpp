#include <catch2/catch.hpp>

#include <array>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "plan/plan.h"
#include "pretended_renders.h"
#include "test_scenes.h"
#include "tracers.h"
#include "wavefront/kernel_scene.h"

using namespace castray;
using namespace castray::test;

namespace {

/// Where a job's pixels are, and their radiance.
using Rendered = std::pair<std::vector<std::uint32_t>, std::vector<float>>;

/// Jobs of a small image of glass on every kernel.
void with_kernels(const std::function<void(const std::function<Rendered(const TileJob&)>&)>& test) {
  const Scene box = standard_scene("kinds/glass_ball");
  RenderOptions options;
  const Plan plan = make_plan(box, options, {64, 64, 0, 0, 64, 64});
  const KernelSceneData data(box, plan, 64, 64, 1);
  for (const KernelApi* kernel : available_kernels()) {
    std::vector<std::uint8_t> memory(kernel->scratch_bytes + 64);
    void* scratch = &memory[64 - reinterpret_cast<std::uintptr_t>(memory.data()) % 64];
    test([&](const TileJob& job) {
      std::vector<std::uint32_t> place(2 * batch_size);
      std::vector<float> radiance(3 * batch_size);
      TileResult result{&place[0],
                        &place[batch_size],
                        {&radiance[0], &radiance[batch_size], &radiance[2 * batch_size]},
                        0,
                        0,
                        0,
                        0};
      KernelOptions k = sharing();
      k.ragged = 0;
      k.sobol = k.jitter = true;
      k.light_points = 8;
      k.most_indirect = std::numeric_limits<float>::infinity();
      kernel->render_tiles[plan.features](data.view, k, job, scratch, result);
      return Rendered{place, radiance};
    });
  }
}

TileJob job_of(std::span<const TilePlace> places, std::uint64_t sample) {
  TileJob job{};
  job.tiles = static_cast<int>(places.size());
  job.sample = sample;
  job.places = places.data();
  return job;
}

}  // namespace

TEST_CASE("tiles of one job that lie apart are as those that lie alone") {
  with_kernels([](const auto& render) {
    const std::array<TilePlace, 3> places{{{8, 16, 2, 2}, {40, 0, 5, 1}, {24, 56, 3, 7}}};
    const auto [all_at, all] = render(job_of(places, 5));
    for (std::size_t k = 0; k < places.size(); ++k) {
      const TilePlace& p = places[k];
      const auto [at, alone] = render({p.x, p.y, p.grid_x, p.grid_y, 1, 5});
      for (std::size_t i = 0; i < tile_pixels; ++i) {
        const std::size_t j = k * tile_pixels + i;
        REQUIRE((all_at[j] == at[i] && all_at[batch_size + j] == at[batch_size + i]));
        for (std::size_t c = 0; c < 3; ++c) REQUIRE(all[c * batch_size + j] == alone[c * batch_size + i]);
      }
    }
  });
}

TEST_CASE("repeats of a tile count up one sequence") {
  with_kernels([](const auto& render) {
    const auto take = [&](std::uint64_t sample, std::uint32_t repeat, std::uint32_t repeats) {
      const TilePlace place{8, 16, 2, 2, repeat, repeats};
      return render(job_of({&place, 1}, sample)).second;
    };
    const std::vector<float> twelfth = take(6, 0, 2);
    CHECK(twelfth == take(3, 0, 4));
    CHECK(twelfth == take(2, 2, 5));
    CHECK(twelfth != take(6, 1, 2));
    CHECK(twelfth != take(12, 0, 1));  // samples without repeats have a sequence of their own
  });
}
