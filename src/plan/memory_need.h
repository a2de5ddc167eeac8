#pragma once

#include <cstdint>

#include "castray/scene.h"
#include "plan/plan.h"

namespace castray {

/// About the most memory, in bytes, that a scene takes besides itself while it is prepared for a render: its
/// tree, or list, its lights, and the table by which an image of the environment is sampled. By what was
/// measured of one triangle, which hardly depends on the mesh.
std::uint64_t bytes_to_prepare(const Scene& scene, const Plan& plan, Integrator integrator);

/// The memory, in bytes, of each thread of a render, at most: paths at work, stack, and the C library's.
inline constexpr std::uint64_t bytes_of_thread = 1 << 20;

}  // namespace castray
