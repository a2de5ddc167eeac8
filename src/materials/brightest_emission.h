#pragma once

#include "castray/scene.h"

namespace castray {

/// A bound of the radiance that the scene emits in any channel, its environment and what images make of
/// materials' emission included. Lights without size do not count.
double brightest_emission(const Scene& scene);

}  // namespace castray
