#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

#include "core/sequences.h"
#include "integrators.h"
#include "materials/kernel_materials.h"
#include "materials/material_table.h"

using namespace castray;
using namespace castray::test;

// Each lane model is the host's: the same values, densities and samples for the same directions and numbers,
// by every instruction set.

namespace {

Material material(MaterialType type, double alpha) {
  Material m{.name = "m", .type = type};
  m.kd = {0.7, 0.4, 0.2};
  m.ks = {0.04, 0.2, 0.6};
  m.reflectance = {0.9, 0.7, 0.3};
  m.transmittance = {0.9, 0.6, 0.3};
  m.alpha = alpha;
  m.metallic = 0.4;
  m.sheen = 0.7;
  m.clearcoat = 0.8;
  m.clearcoat_roughness = 0.4;
  return m;
}

std::vector<Material> all_materials() {
  std::vector<Material> list;
  for (const MaterialDescriptor* descriptor : material_descriptors())
    for (const double alpha : {0.0, 0.05, 0.3, 1.0}) list.push_back(material(descriptor->type, alpha));
  for (const double metallic : {0.0, 1.0}) {
    list.push_back(material(MaterialType::principled, 0.2));
    list.back().metallic = metallic;
    list.back().sheen = list.back().clearcoat = 0;
  }
  list.push_back(material(MaterialType::principled, 0.2));
  list.back().clearcoat_roughness = 0;
  list.push_back(material(MaterialType::microfacet, 0.2));
  list.back().ks = Vec3d(1);
  list.push_back(material(MaterialType::dielectric, 0.3));
  list.back().ior = 1;
  list.push_back(material(MaterialType::dielectric, 0));
  list.back().thin = true;
  list.push_back(list.back());
  list.back().ke = Vec3d(1);  // no window
  for (const double alpha : {0.0, 0.05, 0.3, 1.0})
    for (const bool index : {false, true}) {
      list.push_back(material(MaterialType::conductor, alpha));
      if (index) list.back().eta = {0.2, 0.9, 2.5}, list.back().k = {3.4, 1.5, 0.8};
      list.back().multiple_scattering = alpha > 0.05 || !index;
    }
  for (const double alpha : {0.0, 0.05, 0.3, 1.0}) {
    list.push_back(material(MaterialType::conductor, alpha));
    list.back().anisotropy = 0.8;
    list.push_back(material(MaterialType::principled, alpha));
    list.back().anisotropy = 0.8;
    list.push_back(material(MaterialType::principled, alpha));
    list.back().multiple_scattering = true;
    list.push_back(material(MaterialType::principled, alpha));
    list.back().eta = {0.2, 0.9, 2.5}, list.back().k = {3.4, 1.5, 0.8};
    list.back().clearcoat_ior = 1.8;
  }
  return list;
}

/// Three components of each of `n` vectors, side by side.
struct Vectors {
  std::vector<float> x, y, z;
  explicit Vectors(std::size_t n) : x(n), y(n), z(n) {}
  void set(std::size_t i, const Vec3d& v) {
    x[i] = static_cast<float>(v.x), y[i] = static_cast<float>(v.y), z[i] = static_cast<float>(v.z);
  }
  Vec3d operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

constexpr std::size_t count = 2003;  // no multiple of any width

/// What the lanes are asked, and what they say.
struct Batch {
  Vectors wo{count}, wi{count}, u{count}, f_cos{count}, sampled_wi{count}, weight{count};
  std::vector<float> pdf = std::vector<float>(count), sampled_pdf = pdf, eta2 = pdf, specular = pdf;

  /// Half of the pairs are random; the others are near the mirror direction, where narrow lobes are.
  Batch() {
    for (std::size_t i = 0; i < count; ++i) {
      const auto a = sample_block(SamplerKind::independent, 5, i, 0),
                 b = sample_block(SamplerKind::independent, 5, i, 1);
      const Vec3d o = cosine_hemisphere(Point2<double>{a[0], a[1]});
      Vec3d in = spherical(1 - 2. * a[2], 4. * a[2] * (1 - a[2]), 2 * pi<double> * a[3]);
      if (i % 2) in = normalize(Vec3d(-o.x, -o.y, o.z) + in * 0.1);
      wo.set(i, o);
      wi.set(i, in);
      u.set(i, {b[0], b[1], b[2]});
    }
  }

  void ask(const KernelApi& kernel, const KernelScene& scene, bool front) {
    const BsdfBatch batch{0,
                          front,
                          count,
                          {wo.x.data(), wo.y.data(), wo.z.data()},
                          {wi.x.data(), wi.y.data(), wi.z.data()},
                          {u.x.data(), u.y.data(), u.z.data()},
                          {f_cos.x.data(), f_cos.y.data(), f_cos.z.data()},
                          pdf.data(),
                          {sampled_wi.x.data(), sampled_wi.y.data(), sampled_wi.z.data()},
                          {weight.x.data(), weight.y.data(), weight.z.data()},
                          sampled_pdf.data(),
                          eta2.data(),
                          specular.data()};
    kernel.evaluate_bsdfs(scene, batch);
  }
};

/// Float's rounding, grown by what narrow lobes make of it.
void check_close(double lanes, double host) { CHECK(lanes == Approx(host).epsilon(4e-3).margin(2e-5)); }

void check_close(const Vec3d& lanes, const Vec3d& host) {
  for (int c = 0; c < 3; ++c) check_close(lanes[c], host[c]);
}

}  // namespace

TEST_CASE("each lane model is the host's model", "[bsdf]") {
  for (const Material& m : all_materials()) {
    Scene scene;
    scene.materials = {m};
    const KernelMaterials packed(scene);
    KernelScene view{};
    static_cast<MaterialTables&>(view) = packed.tables();
    const MaterialTable<double> exact(scene.materials);
    for (const std::string& isa : instruction_sets())
      for (const bool front : {true, false}) {
        Batch batch;
        batch.ask(choose_kernel(isa), view, front);
        std::size_t other_branch = 0;
        for (std::size_t i = 0; i < count; ++i) {
          // the lanes' frame has the viewer above it; what lets nothing through is two-sided
          const bool below = !front && traits_of(m) & trait_transmits;
          const auto turned = [&](const Vec3d& w) { return below ? -w : w; };
          const Vec3d wo = turned(batch.wo[i]), wi = turned(batch.wi[i]), u = batch.u[i];
          CAPTURE(descriptor_of(m.type).name, m.alpha, m.metallic, isa, front, i);
          check_close(batch.f_cos[i], exact[0].evaluate(wo, wi) * std::abs(wi.z));
          check_close(batch.pdf[i], exact[0].pdf(wo, wi));
          const BsdfSample<double> s = exact[0].sample(wo, u.x, {u.y, u.z});
          if (!s.valid() || max_component(batch.weight[i]) <= 0) {
            other_branch += s.valid() != (max_component(batch.weight[i]) > 0);
            continue;
          }
          if (length(turned(batch.sampled_wi[i]) - s.wi) > 0.01) {  // u on the other side of a rounded bound
            ++other_branch;
            continue;
          }
          check_close(batch.weight[i], s.weight);
          check_close(batch.sampled_pdf[i] / s.pdf, 1);
          check_close(batch.eta2[i], s.eta2);
          CHECK((batch.specular[i] != 0) == s.specular);
        }
        CAPTURE(descriptor_of(m.type).name, m.alpha, m.ior, m.metallic, isa, front);
        CHECK(other_branch <= 2);
      }
  }
}
