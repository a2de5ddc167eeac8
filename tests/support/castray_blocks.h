#pragma once

#include <catch2/catch.hpp>

#include <functional>
#include <string>
#include <vector>

#include "castray/render.h"
#include "integrators.h"
#include "render_blocks.h"
#include "same_bytes.h"
#include "test_scenes.h"

// Renders of the wavefront against castRay in double precision, block by block.

namespace castray::test {

inline constexpr int side = 32;

inline RenderOptions wavefront_options(std::uint64_t spp, std::uint64_t seed = 1) {
  return wavefront_options(side, spp, seed);
}

inline RenderOptions as_reference(RenderOptions options) {
  options.integrator = Integrator::reference;
  options.precision = Precision::float64;
  options.sampler = SamplerKind::independent;
  options.reuse.automatic = true;
  options.isa = "auto";
  options.accel = AccelKind::bvh;  // takes a third less time than the list, in double
  return options;
}

/// What castRay makes of a scene, with the variance of its mean.
struct Expected : ExpectedBlocks {
  using ExpectedBlocks::ExpectedBlocks;

  explicit Expected(const Scene& scene, const RenderOptions& options = wavefront_options(16),
                    std::uint64_t seeds = 24)
      : ExpectedBlocks(blocks_of(scene, as_reference(options), seeds)) {}

  /// No block is off, at a false-alarm rate of 1e-4 a call, nor are all of them a little, at another one.
  void check(const std::string& what, const Scene& scene, const RenderOptions& options,
             std::uint64_t seeds = 24) const {
    const BlockScores scores = block_scores(blocks_of(scene, options, seeds), mean, variance);
    CAPTURE(what, scores.rms, scores.largest, scores.independent);
    CHECK(scores.largest < score_limit(scores.count, 1e-4));
    CHECK(scores.rms < rms_limit(scores));
  }

  /// The wavefront with other options.
  void check_with(const std::string& what, const Scene& scene,
                  const std::function<void(RenderOptions&)>& change) const {
    RenderOptions options = wavefront_options(4);
    change(options);
    check(what, scene, options);
  }

  /// The wavefront by each instruction set, over list and tree: by the bytes, or the means.
  void check_each_kernel(const Scene& scene) const {
    check_same_bytes(scene, wavefront_options(2));
    check_means(scene, arithmetics());
  }
  void check_means(const Scene& scene, const std::vector<std::string>& sets) const {
    for (const std::string& isa : sets)
      for (const AccelKind accel : {AccelKind::list, AccelKind::bvh})
        check_with(isa + (accel == AccelKind::list ? ", list" : ", tree"), scene, [&](RenderOptions& o) {
          o.isa = isa;
          o.accel = accel;
        });
  }
};

/// Shared and plain paths. Where much of the light comes by rare paths, the spread of a few seeds tells
/// little: take more of them.
inline void check_scene(const std::string& name, const Scene& scene, std::uint64_t seeds = 24) {
  const Expected expected(scene, wavefront_options(16), seeds);
  expected.check(name + ", shared", scene, wavefront_options(4), seeds);
  expected.check(name + ", plain", scene, plain(wavefront_options(8)), seeds);
}

}  // namespace castray::test
