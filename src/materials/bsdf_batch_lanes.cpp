#include "materials/bsdf_batch_lanes.h"

#include "materials/gather_bsdf_lanes.h"

namespace castray::CASTRAY_ISA {

namespace {

CASTRAY_INLINE Vec load_vec(const float* const from[3], uint32_t i, uint32_t count) {
  return {load_padded(from[0], i, count), load_padded(from[1], i, count), load_padded(from[2], i, count)};
}

CASTRAY_INLINE void store_some(float* to, Float v, uint32_t i, uint32_t count) {
  for (uint32_t l = 0; l < width && i + l < count; ++l) to[i + l] = lane(v, (int)l);
}
CASTRAY_INLINE void store_some(float* const to[3], const Vec& v, uint32_t i, uint32_t count) {
  store_some(to[0], v.x, i, count);
  store_some(to[1], v.y, i, count);
  store_some(to[2], v.z, i, count);
}

template <uint32_t features>
CASTRAY_INLINE void evaluate_batch(const MaterialTables& tables, const BsdfBatch& batch) {
  const Uint material = Uint(batch.material * material_floats) | (Uint(batch.front ? 1u : 0u) << 31);
  const Parameters<features> parameters =
      gather_parameters<features>(tables, Uint(batch.material * material_floats));
  const Bsdf bsdf = gather_bsdf<features>(tables, material, parameters);
  for (uint32_t i = 0; i < batch.count; i += width) {
    const Vec wo = load_vec(batch.wo, i, batch.count), wi = load_vec(batch.wi, i, batch.count);
    const Vec u = load_vec(batch.u, i, batch.count);
    const BsdfValue value = evaluate(bsdf, wo, wi);
    store_some(batch.f_cos, value.f_cos, i, batch.count);
    store_some(batch.pdf, value.pdf, i, batch.count);
    const BsdfSample s = sample(bsdf, wo, u.x, u.y, u.z);
    store_some(batch.sampled_wi, s.wi, i, batch.count);
    store_some(batch.weight, s.weight, i, batch.count);
    store_some(batch.sampled_pdf, s.pdf, i, batch.count);
    store_some(batch.eta2, s.eta2, i, batch.count);
    store_some(batch.specular, select(s.specular, Float(1.f), Float(0.f)), i, batch.count);
  }
}

}  // namespace

void evaluate_bsdfs(const MaterialTables& tables, const BsdfBatch& batch) {
  if (tables.stretched)
    evaluate_batch<feature_materials | feature_detail>(tables, batch);
  else
    evaluate_batch<feature_materials>(tables, batch);
}

}  // namespace castray::CASTRAY_ISA
