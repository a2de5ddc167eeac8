#pragma once

#include <vector>

#include "geometry/binning.h"

namespace castray {

/// The boxes of a mesh's triangles, those that waste most cut into smaller ones: `share` times as many as
/// there are triangles are added at most. Long triangles across the axes then no longer fill boxes hundreds
/// of times their size. A triangle may so be in several leaves. Karras, Aila (2013), "Fast Parallel
/// Construction of High-Quality Bounding Volume Hierarchies", section 5.
std::vector<PrimRef> presplit(const MeshView& mesh, double share, int threads);

}  // namespace castray
