#include "lights/light_choice_batch_lanes.h"

#include "lights/light_choice_lanes.h"

namespace castray::CASTRAY_ISA {

void choose_lights(const LightList& list, const LightChoiceBatch& batch) {
  const Receiver receiver =
      receiving_point(list.regions, broadcast(batch.p), broadcast(batch.normal), Mask(true));
  for (uint32_t i = 0; i < batch.count; i += width) {
    const LightChoice chosen = choose_light(list, load_padded(batch.u, i, batch.count),
                                            load_padded(batch.deep, i, batch.count), receiver);
    for (uint32_t l = 0; l < width && i + l < batch.count; ++l) {
      batch.light[i + l] = lane(chosen.light, (int)l);
      batch.probability[i + l] = lane(chosen.probability, (int)l);
    }
  }
}

}  // namespace castray::CASTRAY_ISA
