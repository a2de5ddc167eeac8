#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "core/sequences.h"
#include "integrators.h"
#include "materials/material_table.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// No material reflects more than it receives, at any roughness and angle; whatever receives 1 from everywhere
// and absorbs nothing shows 1.

namespace {

constexpr double roughnesses[] = {0, 1e-3, 0.01, 0.1, 0.3, 0.8, 1};
constexpr double angles[] = {0, 30, 60, 80, 88, 89.9};  ///< degrees from the normal

struct Named {
  std::string name;
  Material material;
};

/// Every material, absorbing nothing; alpha is the square of the roughness.
std::vector<Named> white_materials() {
  std::vector<Named> list{{"diffuse", {.name = {}, .kd = Vec3d(1)}}};
  for (const double r : roughnesses) {
    const double alpha = r * r;
    list.push_back({fmt::format("conductor {}", r),
                    {.name = {}, .type = MaterialType::conductor, .reflectance = Vec3d(1), .alpha = alpha}});
    list.push_back(
        {fmt::format("microfacet {}", r),
         {.name = {}, .type = MaterialType::microfacet, .kd = Vec3d(1), .ks = Vec3d(1), .alpha = alpha}});
    list.push_back(
        {fmt::format("coat {}", r),
         {.name = {}, .type = MaterialType::microfacet, .kd = Vec3d(1), .ks = Vec3d(0.04), .alpha = alpha}});
    list.push_back({fmt::format("principled {}", r),
                    {.name = {},
                     .type = MaterialType::principled,
                     .kd = Vec3d(1),
                     .ks = Vec3d(0.04),
                     .alpha = alpha,
                     .metallic = 0.5,
                     .sheen = 1,
                     .clearcoat = 1,
                     .clearcoat_roughness = r}});
    list.push_back({fmt::format("dielectric {}", r),
                    {.name = {}, .type = MaterialType::dielectric, .alpha = alpha, .ior = 1.5}});
  }
  return list;
}

Vec3d viewer(double degrees) {
  const double theta = degrees / 180 * pi<double>;
  return {std::sin(theta), 0, std::cos(theta)};
}

/// Mean weight of samples, with the scale of radiance by refraction taken out.
template <class T>
Mean sampled_albedo(const Material& material, const Vec3d& wo, std::uint64_t samples, T& largest) {
  const MaterialTable<T> table({material});
  Mean mean;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto u = sample_block(SamplerKind::independent, 77, i, 0);
    const BsdfSample<T> sample = table[0].sample(Vec3<T>(wo), T(u[2]), {T(u[0]), T(u[1])});
    const T weight = sample.valid() ? max_component(sample.weight) * sample.eta2 : T(0);
    largest = std::max(largest, weight);
    mean.add(static_cast<double>(weight));
  }
  return mean;
}

/// The integral of f cos over the hemisphere, for a lobe that is not narrow.
double quadrature_albedo(const Bsdf<double>& bsdf, const Vec3d& wo) {
  constexpr int rings = 600, azimuths = 240;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double s = (i + 0.5) / rings, z = s * s;  // dz = 2 s ds
    for (int j = 0; j < azimuths; ++j) {
      const Vec3d wi = spherical(z, (1 - z) * (1 + z), 2 * pi<double> * (j + 0.5) / azimuths);
      sum += bsdf.evaluate(wo, wi).x * z * 2 * s;
    }
  }
  return sum * 2 * pi<double> / (rings * azimuths);
}

/// Whether a material that absorbs nothing has albedo 1: rough facets lose what they reflect to one another,
/// unless a diffuse base takes it. Coat and what is under it lose what goes to and fro between them.
bool is_lossless(const Material& material) {
  return material.type == MaterialType::diffuse || material.type == MaterialType::microfacet ||
         (material.type != MaterialType::principled && material.alpha < 1e-5);
}

}  // namespace

// 29 materials, 6 angles, 2 precisions: 348 tests at 5 sigma, a false alarm once in 5000 seeds.
TEMPLATE_TEST_CASE("white materials have albedo 1 or less, at any roughness and angle", "[numerics]", float,
                   double) {
  for (const Named& named : white_materials())
    for (const double angle : angles) {
      TestType largest = 0;
      const Mean mean = sampled_albedo<TestType>(named.material, viewer(angle), 20000, largest);
      CAPTURE(named.name, angle, mean.mean(), mean.error(), largest);
      CHECK(mean.mean() < 1 + 5 * mean.error() + 1e-5);
      CHECK(std::isfinite(largest));
      if (is_lossless(named.material)) CHECK(mean.mean() > 1 - 5 * mean.error() - 2e-3);
    }
}

// By quadrature over the hemisphere, finer towards grazing angles; lobes too narrow for it are left to
// sampling.
TEST_CASE("a white coated base has albedo 1 at any angle, roughness and reflectance of the coat",
          "[numerics]") {
  for (const double roughness : {0.5, 0.7, 0.85, 1.0})
    for (const double ks : {0.0, 0.04, 0.3, 0.7, 0.9, 0.99, 0.9999, 1.0}) {
      const MaterialTable<double> table({{.name = {},
                                          .type = MaterialType::microfacet,
                                          .kd = Vec3d(1),
                                          .ks = Vec3d(ks),
                                          .alpha = roughness * roughness}});
      for (double angle = 0.5; angle < 88; angle += 4.45) {
        const double albedo = quadrature_albedo(table[0], viewer(angle));
        CAPTURE(roughness, ks, angle);
        CHECK(albedo == Approx(1).margin(2e-3));
      }
    }
}

// 9 x 8 x 20 means of 4000 samples at 5 sigma: a false alarm once in 1000 seeds. Samples may weigh much only
// where they are few: the standard error says so.
TEMPLATE_TEST_CASE("a white coat never reflects more than it receives, nor in bright specks", "[numerics]",
                   float, double) {
  for (const double roughness : {0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.6, 1.0})
    for (const double ks : {0.0, 0.04, 0.3, 0.7, 0.9, 0.99, 0.9999, 1.0}) {
      const Material material{.name = {},
                              .type = MaterialType::microfacet,
                              .kd = Vec3d(1),
                              .ks = Vec3d(ks),
                              .alpha = roughness * roughness};
      for (double angle = 0.5; angle < 90; angle += 4.45) {
        TestType largest = 0;
        const Mean mean = sampled_albedo<TestType>(material, viewer(angle), 4000, largest);
        CAPTURE(roughness, ks, angle, mean.mean(), mean.error(), largest);
        CHECK(mean.mean() < 1 + 5 * mean.error() + 1e-5);
        // What facets of a narrow lobe lose to one another at grazing angles is not all given back.
        const double lost = roughness < 0.1 ? 0.12 : 2e-3;
        CHECK(mean.mean() > 1 - 5 * mean.error() - lost);
        CHECK(largest < 150);
        CHECK(mean.error() < 0.1);
      }
    }
}

TEST_CASE("white materials are reciprocal down to grazing angles", "[numerics]") {
  for (const Named& named : white_materials()) {
    const MaterialTable<double> table({named.material});
    for (const double a : angles)
      for (const double b : angles)
        for (const double turn : {0.1, 2.0, 3.1}) {
          const Vec3d wo = viewer(a);
          const Vec3d in = viewer(b), wi{in.x * std::cos(turn), in.x * std::sin(turn), in.z};
          CAPTURE(named.name, a, b, turn);
          const double forth = table[0].evaluate(wo, wi).x, back = table[0].evaluate(wi, wo).x;
          CHECK(forth == Approx(back).epsilon(1e-9).margin(1e-12));
        }
  }
}

namespace {

/// A plate under a sky of radiance 1, seen at an angle: its radiance is its albedo there.
Scene plate(const Material& material, double degrees) {
  SceneSketch sketch;
  sketch.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, sketch.add_material(material));
  sketch.scene.environment = {1, 1, 1};
  sketch.scene.camera = make_camera(viewer(degrees) * 0.5, {0, 0, 0}, {0, 1, 0}, 0.01);
  return sketch.scene;
}

Mean rendered_albedo(const Scene& scene, RenderOptions options) {
  options.width = options.height = 16;
  options.spp = 16;
  options.threads = 1;
  Mean mean;
  for (options.seed = 1; options.seed <= 8; ++options.seed) {
    double sum = 0;
    for (const Vec3f& pixel : render(scene, options).film.image().pixels) sum += pixel.x;
    mean.add(sum / (16 * 16));
  }
  return mean;
}

}  // namespace

// 22 materials, 2 angles, 4 ways: 176 t-tests with 7 degrees of freedom, of which 11 is 1e-5.
TEST_CASE("plates under a white sky show their albedo on the wavefront", "[numerics]") {
  for (const Named& named : white_materials()) {
    if (named.material.type == MaterialType::dielectric) continue;  // a plate's other side lets it out
    for (const double angle : {0., 80.}) {
      double largest = 0;
      const Mean expected = sampled_albedo<double>(named.material, viewer(angle), 20000, largest);
      for (const Way& way : every_way({})) {
        if (way.options.integrator == Integrator::reference || way.options.isa != choose_kernel("auto").name)
          continue;
        const Mean mean = rendered_albedo(plate(named.material, angle), way.options);
        const double error = std::hypot(mean.error(), expected.error());
        CAPTURE(named.name, angle, way.name, mean.mean(), expected.mean(), error);
        CHECK(std::abs(mean.mean() - expected.mean()) < 11 * error + 1e-3);
        CHECK(mean.mean() < 1 + 11 * error + 1e-5);
      }
    }
  }
}
