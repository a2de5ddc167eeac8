#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "castray/render_options.h"
#include "castray/scene.h"
#include "core/contract.h"

namespace castray {

/// What is chosen for a scene before it is rendered.
struct Plan {
  bool list = false;                   ///< a flat list instead of a tree
  std::uint32_t features = 0;          ///< KernelFeature set of the kernel
  bool mis = false;                    ///< light and BSDF sampling share emission
  bool light_paths = false;            ///< bring the caustics that the camera sees directly
  double light_paths_per_pixel = 1;    ///< of the full image, for each sample
  bool twice_the_light_paths = false;  ///< these are twice as many as usual
  int suffixes = 0;                    ///< shared by each 8x8 tile; 0: no sharing
  int few_suffixes = 0;                ///< where so many may do: beside mirrors and glass; or 0
  std::uint32_t first_roulette = first_roulette_vertex;  ///< vertex of plain paths where it starts
  int branches = 1;                                      ///< of plain paths, from what a camera ray meets
  int light_points = 0;                                  ///< shared by each tile
  int environment_points = 0;                            ///< likewise
  bool choose_lights_by_importance = false;              ///< for the point to be lit, instead of by power
  bool reconstruct = false;            ///< if paths are shared, films keep what images are reconstructed from
  int edge_samples = 1;                ///< if so: of tiles that see an edge, for each of the others
  std::size_t light_regions = 0;       ///< from which it is known what lights are seen; 0: it is not
  double gain_of_regions = 1;          ///< how many times smaller they make a light sample's mean square
  bool lights_by_solid_angle = false;  ///< points on them, where that can be had
  bool narrow_coats = false;           ///< of surfaces, as SceneNeeds has it
  bool matte = false;                  ///< no surface leads paths of a pixel's own, or is there by chance
  BuildQuality build = BuildQuality::fast;  ///< of the tree
  double gain_of_light_paths = 0;           ///< over chance, as a pilot saw it; 0: none was asked
  double gain_of_reconstruction = 0;        ///< over means, likewise
  std::string kernel;                       ///< what was chosen, readable
  std::vector<std::string> skipped;         ///< what the scene does not need
};

/// For an image of the window's full size. Automatic sharing and reconstruction are on here; a pilot may take
/// them back (choose_by_pilot, choose_reconstruction).
Plan make_plan(const Scene& scene, const RenderOptions& options, const Window& window);

/// Whether the films of this render keep what images are reconstructed from. (Those of a render to a target
/// error do so if it takes many samples.)
bool keeps_differences(const RenderOptions& options, const Plan& plan);

/// What the image of a film, which keeps differences or not, is made of, and why: for after Plan::kernel.
/// Empty where no pilot was asked.
std::string image_source(const Plan& plan, bool differences);

/// Lets the choice of lights know what is seen from regions, by which light samples have a mean square that
/// many times smaller, and says so in Plan::kernel.
void choose_lights_by_regions(Plan& plan, std::size_t regions, double gain);

/// Takes what does better, if light paths make a render that many times as efficient as leaving their
/// caustics to chance.
void choose_caustics(Plan& plan, double gain_of_light_paths);

/// Takes twice as many light paths if these are that many times as efficient, and that is much.
void choose_number_of_light_paths(Plan& plan, double gain_of_twice);

/// Lets two branches go on where paths are plain, if these are that many times as efficient as one and it is
/// more than 1.1, and than the root of the standard error, a factor. Says so in Plan::kernel. After
/// choose_by_pilot.
void choose_two_branches(Plan& plan, double gain, double error);

/// Keeps reconstruction if it is more efficient than means, that many times by a pilot; nothing if none was
/// asked.
void choose_reconstruction(Plan& plan, std::optional<double> gain);

/// Takes shared paths if these are that many times as efficient as plain ones and it is more than the
/// standard error, a factor, or than 1.5. `few`: that is with few suffixes, which are taken unless plain
/// paths are better by as much, or all is known from single samples alone, or paths from lights do 200 times
/// better than chance, where a gain of 1.5 is needed. Says so in Plan::kernel. After choose_caustics.
void choose_by_pilot(Plan& plan, double gain_of_sharing, double error, bool few = false,
                     bool by_single_samples = false);

}  // namespace castray
