#pragma once

#include <cstdint>
#include <string>

#include "castray/render_options.h"
#include "castray/scene.h"
#include "plan/fault.h"

namespace castray {

/// What jobs need of a scene, found once.
struct SceneFacts {
  std::string name, file;
  int width = 0, height = 0;  ///< its image size
  std::uint64_t hash = 0;     ///< of all that samples depend on
  double brightest = 0;       ///< greatest component of emitted radiance
  std::size_t triangles = 0;
};
SceneFacts facts_of(const Scene& scene);

/// One render, decided: options that are checked, and what they leave open filled in.
struct Job {
  RenderOptions options;  ///< `integrator` is not automatic
  Fault fault = Fault::none;
  Window window;        ///< the crop, or all of the image
  SampleRange samples;  ///< indices; with a target error, the most
  int threads = 1;
  double brightest = 0;  ///< bound of emitted radiance
  std::string key;       ///< of the film
};

/// Throws InputError if the options contradict one another or the scene.
Job make_job(const SceneFacts& scene, const RenderOptions& options, Fault fault = Fault::none);

/// The window that the options ask for, unchecked.
Window window_of(int scene_width, int scene_height, const RenderOptions& options);

}  // namespace castray
