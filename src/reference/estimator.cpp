#include "reference/estimator.h"

namespace castray {

bool uses_mis(Switch mis, double emitting_share_of_surface) {
  return mis == Switch::automatic ? emitting_share_of_surface > emitting_share_for_mis : mis == Switch::on;
}

}  // namespace castray
