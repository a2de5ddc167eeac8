#pragma once

#include "simd/lanes.h"

namespace castray::CASTRAY_ISA {

/// The angle of (x,y) from the x axis towards the y axis, in [0,1] turns, within 1e-7; 0 at the origin. The
/// arcus tangens of up to 1 is Abramowitz and Stegun's 4.4.49.
CASTRAY_INLINE Float turn_of(Float y, Float x) {
  const Float along_x = abs(x), along_y = abs(y);
  const Float a = min(along_x, along_y) / max(max(along_x, along_y), Float(0x1p-100f)), z = a * a;
  constexpr float coefficient[] = {-0.0161657367f, 0.0429096138f, -0.0752896400f, 0.1065626393f,
                                   -0.1420889944f, 0.1999355085f, -0.3333314528f, 1.f};
  Float series(0.0028662257f);
  for (const float next : coefficient) series = fma(series, z, Float(next));
  Float turn = series * a * Float(0.159154943f);
  turn = select(along_y > along_x, Float(0.25f) - turn, turn);
  turn = select(x < Float(0.f), Float(0.5f) - turn, turn);
  return select(y < Float(0.f), Float(1.f) - turn, turn);
}

}  // namespace castray::CASTRAY_ISA
