#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "castray/vec.h"
#include "wavefront/kernel_api.h"

namespace castray {

/// One job's radiance and rays. Called by several threads of one team at once.
using RenderJob = std::function<void(const KernelOptions&, const TileJob&, TileResult&)>;

/// What pilots render: a few tiles of an image, some samples in each of some independent replicates.
struct Pilot {
  int width, height;  ///< of the full image
  bool list;          ///< geometry is a list of facets instead of a tree
  int threads;
  RenderJob render_job;
  double light_paths_per_pixel = 1;  ///< as in Plan
  bool narrow_coats = false;         ///< as in Plan
  bool matte = false;                ///< likewise
};

/// Of one technique, means over pixels. Errors are the sum over channels of the variance over replicates,
/// relative as relMSE is, times the number of samples of which it is the variance.
struct TechniqueFigures {
  Vec3d brightness;         ///< without what the camera sees of emitters, as errors are
  double error = 0;         ///< of means over some samples
  double single_error = 0;  ///< of single samples; 0 where `error` is that
  /// The share of `error` that neighbours do not have alike: that of half of the variance of their
  /// differences.
  double own_share = 1;
  double lonely_error = 0;  ///< of `error`, what single pixels have beyond all of their tile, in all tiles
  /// Of `error`, what the techniques have alike, as their samples see the same places of a pixel: at edges,
  /// borders of shadows, in textures. Found in matte scenes alone; elsewhere 0.
  double camera_error = 0;
  double cost = 0;  ///< of a sample, in rays, of which what pixels gather is a fraction
};

/// Samples of a tile, in each of its replicates.
enum class Samples : std::size_t { one = 1, four = 4 };

/// Tries techniques on the same tiles, group after group of them, each spread over the image. What the camera
/// sees of emitters is noise of all alike, and left out. Nothing depends on the seed of the options, or on
/// threads.
class TileTrials {
 public:
  TileTrials(Pilot pilot, std::vector<KernelOptions> techniques, Samples samples);

  /// Tries one more group. False, and nothing done, if the image is too small to spare more tiles.
  bool try_more();

  std::size_t tiles() const { return by_tile_.size(); }
  Samples samples() const { return samples_; }

  /// Of all that was tried; and of one more group, with so many samples of each tile; in rays.
  double cost() const { return cost_; }
  double cost_of_group(Samples samples) const;

  /// Of each technique, over the tiles tried until now.
  std::vector<TechniqueFigures> figures() const;

  /// The same, had this tile not been among them.
  std::vector<TechniqueFigures> figures_without(std::size_t tile) const;

 private:
  Pilot pilot_;
  std::vector<KernelOptions> techniques_;
  Samples samples_;
  std::vector<std::vector<TechniqueFigures>> by_tile_;
  double cost_ = 0;
};

}  // namespace castray
