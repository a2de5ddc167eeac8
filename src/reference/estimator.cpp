#include "reference/estimator.h"

namespace castray {

bool uses_mis(Switch mis, double emitting_share_of_surface) {
  // a lamp is a hundredth of a room; a furnace is all emitter
  constexpr double large_share = 0.1;
  return mis == Switch::automatic ? emitting_share_of_surface > large_share : mis == Switch::on;
}

}  // namespace castray
