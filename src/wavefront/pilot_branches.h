#pragma once

#include "wavefront/pilot_tiles.h"

namespace castray {

/// How many times as efficient as one two plain paths are that go on from what a camera ray meets, and the
/// standard error of that, as a factor.
struct BranchGain {
  double gain = 1, error = 1;
};

/// Tries one and two branches on some tiles. What both have alike, as their samples see the same places of a
/// pixel and the same points of lights, branches do not lessen; the rest is half as much of two. (Four gain
/// about as much as two, where they gain.)
///
/// Takes at most 2.5 % of the rays of an image of 16 samples, or its first tiles, and depends on what
/// find_gains depends on. A gain of 1 if the image is too small for that.
BranchGain find_branches(const Pilot& pilot, KernelOptions options);

}  // namespace castray
