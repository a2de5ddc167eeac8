#include <catch2/catch.hpp>

#include <complex>

#include "bsdf_materials.h"
#include "materials/coverage.h"

// What each material's BSDF is.

using namespace castray;
using namespace castray::test;

TEST_CASE("a principled material all of metal by its index is the conductor under its coat", "[bsdf]") {
  Material gold = conductor(0.2);
  gold.eta = {0.16, 0.42, 1.38}, gold.k = {4, 2.04, 1.74};
  gold.anisotropy = 0.6;
  Material bare = gold;
  bare.type = MaterialType::principled;
  bare.kd = gold.reflectance, bare.metallic = 1;
  Material coated = bare;
  coated.clearcoat = 1, coated.clearcoat_roughness = 0.3, coated.clearcoat_ior = 1.7;
  const MaterialTable<double> table({gold, bare, coated});
  for (const Vec3d& wo : viewers<double>())
    for (std::uint64_t i = 0; i < 200; ++i) {
      const BsdfSample<double> s = draw(table[0], wo, 9, i);
      if (!s.valid()) continue;
      CHECK(length(table[1].evaluate(wo, s.wi) - table[0].evaluate(wo, s.wi)) <=
            1e-9 * length(table[0].evaluate(wo, s.wi)));
    }
  for (const double theta : {0.1, 0.8, 1.3, 1.5})
    for (const double phi : {0.0, 0.7, 1.5}) CHECK(albedo_of_white(table[2], direction(theta, phi)) <= 1);
}

TEST_CASE("a lobe that is not round is wide along x", "[bsdf]") {
  Material white = brushed(0.3);
  white.reflectance = Vec3d(1);
  const double ratio = 1 - white.anisotropy;
  const Ggx<double> along{white.alpha / std::sqrt(ratio)}, across{white.alpha * std::sqrt(ratio)};
  const MaterialTable<double> table({white});
  const Vec3d up(0, 0, 1);
  for (const double theta : {0.2, 0.6}) {
    const auto f = [&](double phi) { return table[0].evaluate(up, direction(theta, phi)).x; };
    // In the planes of its axes D is that of a round lobe of that width, but for the width across.
    const auto d = [&](const Ggx<double>& ggx) { return ggx.distribution(direction(theta / 2, 0.)); };
    const auto g = [&](const Ggx<double>& ggx) { return ggx.shadowing_over_cos(up, direction(theta, 0.)); };
    CHECK(f(0) == Approx(d(along) * g(along) / ratio));
    CHECK(f(pi<double> / 2) == Approx(d(across) * g(across) * ratio));
    CHECK(f(pi<double>) == Approx(f(0)));
  }
  for (const Vec3d& wo : viewers<double>())
    for (std::uint64_t i = 0; i < 1000; ++i) CHECK(draw(table[0], wo, 7, i).weight.x <= 1 + 1e-9);
}

TEST_CASE("a pane reflects what its two surfaces do, and the rest goes straight on", "[bsdf]") {
  Material m = dielectric(0);
  m.thin = true, m.transmittance = {1, 0.5, 0.25};
  m.ke = Vec3d(1);  // no window, through which rays pass without a vertex
  const MaterialTable<double> table({m});
  for (const double theta : {0.1, 1.0, 1.5, 2.0, 3.0}) {  // on either side
    const Vec3d wo = direction(theta, 0.7);
    const double f = fresnel_dielectric(std::abs(wo.z), 1.5), passed = (1 - f) * (1 - f) / (1 - f * f);
    const auto mirrored = table[0].sample(wo, 0.999 * (1 - passed), {0.3, 0.4}),
               straight = table[0].sample(wo, 1.001 * (1 - passed), {0.3, 0.4});
    CHECK(length(straight.wi + wo) < 1e-12);
    CHECK(length(mirrored.wi - Vec3d(-wo.x, -wo.y, wo.z)) < 1e-12);
    CHECK(straight.pdf == Approx(passed));
    CHECK(mirrored.pdf == Approx(1 - passed));
    CHECK(straight.weight.y == 0.5);
    CHECK(mirrored.weight.y == 1);
    CHECK((straight.eta2 == 1 && straight.specular && mirrored.specular));
  }
}

TEST_CASE("what vertices of a window mirror, and what passes as if nothing were there, is a pane's",
          "[bsdf]") {
  for (const Vec3d& transmittance : {Vec3d(1), Vec3d(0.5), Vec3d(1, 0.5, 0.25), Vec3d(0, 0.5, 1)})
    for (const double ior : {1.0, 1.5}) {
      Material m = dielectric(0);
      m.thin = true, m.transmittance = transmittance, m.ior = ior;
      const MaterialTable<double> table({m});
      Scene scene;
      scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
      scene.triangles = {{0, 1, 2}};
      scene.triangle_material = {0};
      scene.materials = {m};
      const Coverage coverage(scene);
      CHECK(coverage.tints() == (transmittance.x != transmittance.z));
      for (const double theta : {0.1, 1.0, 1.5, 2.0, 3.0}) {
        const Vec3d wo = direction(theta, 0.7);
        const double reflected = pane_reflectance(std::abs(wo.z), ior);
        const Hit<float> hit{1, 0, 0.3f, 0.3f};
        const double there = static_cast<double>(coverage.share_there(hit, Vec3f(-wo)));
        const Vec3d passed = Vec3d(coverage.tint(hit, Vec3f(-wo))) * (1 - there);
        const BsdfSample<double> s = table[0].sample(wo, 0.7, {0.3, 0.4});
        const Vec3d mirrored = s.valid() ? s.weight * there : Vec3d();
        CAPTURE(transmittance.x, transmittance.z, ior, theta);
        CHECK(length(mirrored - Vec3d(reflected)) < 1e-6);
        CHECK(length(passed - transmittance * (1 - reflected)) < 1e-6);
        if (s.valid()) CHECK(length(s.wi - Vec3d(-wo.x, -wo.y, wo.z)) < 1e-12);
      }
    }
}

TEST_CASE("a metal's reflectance follows Fresnel's equations at each angle", "[bsdf]") {
  // Without absorption it is glass; from within, total reflection.
  for (const double eta : {1.5, 1 / 1.5})
    for (const double cosine : {0.02, 0.3, 0.7, 1.0})
      CHECK(fresnel_conductor(cosine, eta, 0.0) == Approx(fresnel_dielectric(cosine, eta)).margin(1e-7));
  // The amplitudes of both polarisations, by complex numbers.
  const double eta = 0.42, k = 2.35;
  for (const double cosine : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    const std::complex<double> n(eta, k), cos_t = std::sqrt(1. - (1 - cosine * cosine) / (n * n));
    const double s = std::norm((cosine - n * cos_t) / (cosine + n * cos_t)),
                 p = std::norm((n * cosine - cos_t) / (n * cosine + cos_t));
    CHECK(fresnel_conductor(cosine, eta, k) == Approx((s + p) / 2));
  }
  CHECK(mean_fresnel(rough_gold(0.5)).z < 1);
  Material m = rough_gold(0);
  const MaterialTable<double> table({m});
  CHECK(table[0].sample(direction(1.2, 0.), 0.5, {0.3, 0.4}).weight.y ==
        Approx(fresnel_conductor(std::cos(1.2), m.eta.y, m.k.y)));
}

TEST_CASE("with what facets reflect more than once, a white metal reflects all", "[bsdf]") {
  for (const double alpha : {0.05, 0.2, 0.5, 1.0}) {
    Material m = conductor(alpha);
    m.reflectance = Vec3d(1);
    const MaterialTable<double> once({m});
    m.multiple_scattering = true;
    const MaterialTable<double> table({m});
    for (int angle = 0; angle < 10; ++angle) {
      const double theta = (angle + 0.2) / 10 * pi<double> / 2;
      CAPTURE(alpha, angle);
      CHECK(albedo_by_quadrature(table[0], theta).x == Approx(1).margin(1e-3));
      if (alpha == 1) CHECK(albedo_by_quadrature(once[0], theta).x < 0.9);
    }
    // Where facets absorb, the second reflection has the colour twice: more saturated than the first.
    m.reflectance = {0.9, 0.5, 0.1};
    const MaterialTable<double> coloured({m});
    const Vec3d albedo = albedo_by_quadrature(coloured[0], 0.5);
    if (alpha == 1) CHECK(albedo.x / albedo.y > 0.9 / 0.5);
    CHECK(albedo.x < 0.9);
  }
}

TEST_CASE("with what facets reflect more than once, a white principled metal reflects all", "[bsdf]") {
  for (const double alpha : {0.2, 1.0})
    for (const double metallic : {0.0, 0.5, 1.0}) {
      Material m = principled(alpha);
      m.kd = Vec3d(1);
      m.metallic = metallic;
      m.sheen = m.clearcoat = 0;
      const MaterialTable<double> once({m});
      m.multiple_scattering = true;
      const MaterialTable<double> table({m});
      for (int angle = 0; angle < 10; ++angle) {
        const double theta = (angle + 0.2) / 10 * pi<double> / 2;
        CAPTURE(alpha, metallic, angle);
        CHECK(albedo_by_quadrature(table[0], theta).x == Approx(1).margin(1e-3));
        if (alpha * metallic == 1) CHECK(albedo_by_quadrature(once[0], theta).x < 0.9);
      }
      // The metal's part is the conductor's whose facets have this mean reflectance.
      m.kd = {0.9, 0.5, 0.1};
      Material metal = conductor(alpha);
      metal.reflectance = mean_schlick(m.kd);
      const auto again = [](Material material) {
        const Vec3d wo = direction(0.4, 0.), wi = direction(1., 2.);
        material.multiple_scattering = true;
        const Vec3d both = MaterialTable<double>({material})[0].evaluate(wo, wi);
        material.multiple_scattering = false;
        return both - MaterialTable<double>({material})[0].evaluate(wo, wi);
      };
      for (int c = 0; c < 3; ++c) CHECK(again(m)[c] == Approx(metallic * again(metal)[c]).margin(1e-9));
    }
}

TEST_CASE("a principled material is what its parts are", "[bsdf]") {
  const Vec3d wo = direction(0.7, 0.4);
  const auto f = [&](Material m, const Vec3d& wi) {
    return MaterialTable<double>({std::move(m)})[0].evaluate(wo, wi);
  };
  Material m = principled(0.3);
  m.sheen = m.clearcoat = 0;
  Material coated = microfacet(0.3), metal = microfacet(0.3, 0);
  coated.kd = m.kd, coated.ks = m.ks, metal.ks = m.kd;
  for (const double theta : {0.1, 0.7, 1.4}) {
    const Vec3d wi = direction(theta, 3.0);
    const Vec3d blend = f(coated, wi) * (1 - m.metallic) + f(metal, wi) * m.metallic;
    for (int c = 0; c < 3; ++c) CHECK(f(m, wi)[c] == Approx(blend[c]).epsilon(1e-9));
  }
  // Where nothing is reflected inside, clear coat and sheen are seen alone.
  Material black{.name = {}, .type = MaterialType::principled, .kd = Vec3d(0), .alpha = 1};
  black.clearcoat = 0.5, black.clearcoat_roughness = 0.6;
  Material outer = microfacet(0.36, 0);
  outer.ks = Vec3d(0.04);
  const Vec3d mirrored(-wo.x, -wo.y, wo.z);
  Material bare = black;
  bare.clearcoat = 0;
  const double inner = f(bare, mirrored).x;
  CHECK(f(black, mirrored).x == Approx(0.5 * f(outer, mirrored).x).margin(inner));
  CHECK(f(black, mirrored).x > 0.5 * f(outer, mirrored).x);
  bare.sheen = 1;
  const Vec3d grazing = direction(1.5, 3.5), h = normalize(wo + grazing);
  const double sheen = std::pow(1 - dot(wo, h), 5);
  bare.alpha = 0.001;  // its own lobe is elsewhere
  CHECK(f(bare, grazing).x == Approx(sheen).epsilon(1e-3));
}

TEST_CASE("a white principled material never reflects more than it receives", "[bsdf]") {
  for (const double alpha : {0.2, 0.7})
    for (const double metallic : {0.0, 0.5, 1.0})
      for (const double layers : {0.0, 1.0}) {
        Material m = principled(alpha, 1);
        m.kd = Vec3d(1);
        m.metallic = metallic;
        m.sheen = m.clearcoat = layers;
        const MaterialTable<double> table({m});
        for (int angle = 0; angle < 10; ++angle) {
          const double albedo = albedo_by_quadrature(table[0], (angle + 0.2) / 10 * pi<double> / 2).x;
          CAPTURE(alpha, metallic, layers, angle, albedo);
          CHECK(albedo <= 1 + 1e-5);
          if (metallic == 0 && layers == 0) CHECK(albedo == Approx(1).margin(1e-3));
          if (metallic == 0) CHECK(albedo > 0.85);  // coat and base lose what goes to and fro between them
        }
      }
}

TEST_CASE("smooth lobes are mirrors, refraction obeys Snell's law, Fresnel's weights sum to one", "[bsdf]") {
  const Vec3d wo = direction(0.6, 0.0);
  const MaterialTable<double> table({conductor(0), dielectric(0), microfacet(0)});
  const auto mirror = table[0].sample(wo, 0.5, {0.3, 0.4});
  CHECK(mirror.specular);
  CHECK(mirror.wi == Vec3d(-wo.x, -wo.y, wo.z));
  CHECK(mirror.weight == Vec3d(1, 0.8, 0.4));
  CHECK(table[0].evaluate(wo, mirror.wi) == Vec3d());
  CHECK(table[0].pdf(wo, mirror.wi) == 0);

  const auto refracted = table[1].sample(wo, 0.99, {0.3, 0.4});
  REQUIRE(refracted.wi.z < 0);
  CHECK(std::sin(0.6) == Approx(1.5 * std::hypot(refracted.wi.x, refracted.wi.y)));
  CHECK(refracted.weight.x * refracted.eta2 == Approx(1));
  const auto reflected = table[1].sample(wo, 0.0, {0.3, 0.4});
  REQUIRE(reflected.wi.z > 0);
  CHECK(reflected.pdf + refracted.pdf == Approx(1));
  CHECK(fresnel_dielectric(1.0, 1.5) == Approx(0.04));
  CHECK(fresnel_dielectric(0.1, 1 / 1.5) == 1);

  const auto coat = table[2].sample(wo, 0.0, {0.3, 0.4});
  CHECK(coat.specular);
  CHECK(coat.wi == Vec3d(-wo.x, -wo.y, wo.z));
  CHECK(max_component(table[2].evaluate(wo, coat.wi)) > 0);  // the diffuse base
}
