#pragma once

#include "castray/vec.h"

namespace castray {

/// Rounds a vector to a field of a kernel's record.
template <class T>
void put(float (&out)[3], const Vec3<T>& v) {
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(v[c]);
}

}  // namespace castray
