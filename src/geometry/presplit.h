#pragma once

#include <vector>

#include "geometry/binning.h"

namespace castray {

/// Boxes of a mesh's triangles, those that waste most space cut into smaller ones: at most `share` times
/// as many are added as there are triangles. Long triangles across the axes have boxes hundreds of times
/// their size. A triangle may end up in several leaves. Karras, Aila (2013), "Fast Parallel Construction
/// of High-Quality Bounding Volume Hierarchies", section 5.
std::vector<PrimRef> presplit(const MeshView& mesh, double share, int threads);

}  // namespace castray
