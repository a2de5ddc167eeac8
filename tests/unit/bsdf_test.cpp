#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "bsdf_materials.h"
#include "statistics.h"

using namespace castray;
using namespace castray::test;

// One harness for every BSDF: whatever keeps the contract of materials/bsdf_sample.h passes.

namespace {

struct Named {
  std::string name;
  Material material;
};

std::vector<Named> rough_materials() {
  std::vector<Named> list{{"diffuse", diffuse()}};
  for (const double alpha : {0.1, 0.3, 0.8, 1.0}) {
    list.push_back({fmt::format("conductor {}", alpha), conductor(alpha)});
    list.push_back({fmt::format("gold {}", alpha), rough_gold(alpha)});
    if (alpha == 0.3) list.push_back({"brushed", brushed(alpha)});
    list.push_back({fmt::format("microfacet {}", alpha), microfacet(alpha)});
    list.push_back({fmt::format("dielectric {}", alpha), dielectric(alpha)});
    list.push_back({fmt::format("principled {}", alpha), principled(alpha)});
    if (alpha == 0.3) {
      list.push_back({"principled, brushed", principled(alpha)});
      list.back().material.anisotropy = 0.8;
      list.push_back({"principled, gold", principled(alpha)});
      list.back().material.eta = {0.16, 0.42, 1.38}, list.back().material.k = {4, 2.04, 1.74};
      list.back().material.clearcoat_ior = 1.8;
    }
    if (alpha == 0.8) {
      list.push_back({"principled, again", principled(alpha)});
      list.back().material.multiple_scattering = true;
    }
  }
  return list;
}

constexpr int rows = 20, columns = 24;

std::size_t cell_of(const Vec3d& w) {
  const double phi = std::atan2(w.y, w.x);
  const int row = std::min(rows - 1, static_cast<int>((w.z + 1) / 2 * rows));
  const int column = std::min(columns - 1, static_cast<int>((phi / (2 * pi<double>)+0.5) * columns));
  return static_cast<std::size_t>(row * columns + column);
}

/// The density integrated over one cell.
double cell_probability(const Bsdf<double>& bsdf, const Vec3d& wo, int row, int column,
                        const GaussRule& rule) {
  double sum = 0;
  for (std::size_t i = 0; i < rule.x.size(); ++i)
    for (std::size_t j = 0; j < rule.x.size(); ++j) {
      const double z = 2 * (row + rule.x[i]) / rows - 1;
      const double phi = 2 * pi<double> * ((column + rule.x[j]) / columns - 0.5);
      sum += rule.w[i] * rule.w[j] * bsdf.pdf(wo, spherical(z, 1 - z * z, phi));
    }
  return sum * 4 * pi<double> / (rows * columns);
}

constexpr int samples = 50000;

/// How many of the samples are expected in each cell; the last entry counts those that are none.
std::vector<double> expected_counts(const Bsdf<double>& bsdf, const Vec3d& wo) {
  static const GaussRule rule(32);
  std::vector<double> expected;
  double none = samples;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      expected.push_back(samples * cell_probability(bsdf, wo, row, column, rule));
      none -= expected.back();
    }
  expected.push_back(std::max(none, 0.0));
  return expected;
}

template <class T>
std::vector<double> sampled_counts(const Material& material, const Vec3d& wo, std::uint32_t key) {
  const MaterialTable<T> table({material});
  std::vector<double> counts(rows * columns + 1);
  for (std::uint64_t i = 0; i < samples; ++i) {
    const BsdfSample<T> sample = draw(table[0], Vec3<T>(wo), key, i);
    ++counts[sample.valid() ? cell_of(Vec3d(sample.wi)) : counts.size() - 1];
  }
  return counts;
}

}  // namespace

// 25 materials, 4 viewers, 2 precisions: 200 tests, each at 1e-5, so a false alarm once in 500 seeds.
TEST_CASE("samples are distributed as the density says", "[bsdf]") {
  std::uint32_t key = 1;
  for (const Named& named : rough_materials()) {
    const MaterialTable<double> table({named.material});
    for (const Vec3d& wo : viewers<double>()) {
      CAPTURE(named.name, wo.x, wo.y, wo.z);
      const std::vector<double> expected = expected_counts(table[0], wo);
      CHECK(chi_square_probability(sampled_counts<float>(named.material, wo, ++key), expected) > 1e-5);
      CHECK(chi_square_probability(sampled_counts<double>(named.material, wo, ++key), expected) > 1e-5);
    }
  }
}

TEMPLATE_TEST_CASE("a sample's weight is value times cosine over density", "[bsdf]", float, double) {
  constexpr bool wide = std::is_same_v<TestType, double>;
  for (const Named& named : rough_materials()) {
    const MaterialTable<TestType> table({named.material});
    for (const Vec3<TestType>& wo : viewers<TestType>())
      for (std::uint64_t i = 0; i < 1000; ++i) {
        const auto sample = draw(table[0], wo, 5, i);
        if (!sample.valid() || std::abs(sample.wi.z) < TestType(0.01)) continue;
        CAPTURE(named.name, wo.x, wo.y, wo.z, i);
        const auto expected = table[0].evaluate(wo, sample.wi) * (std::abs(sample.wi.z) / sample.pdf);
        // in float the facet normal, found again from wo + wi, has an error of 1e-7 / alpha at grazing angles
        REQUIRE(sample.weight.y == Approx(expected.y).epsilon(wide ? 1e-7 : 2e-2));
        REQUIRE(sample.pdf == Approx(table[0].pdf(wo, sample.wi)).epsilon(wide ? 1e-7 : 2e-2));
        REQUIRE(length(sample.wi) == Approx(1).epsilon(1e-5));
        REQUIRE_FALSE(sample.specular);
      }
  }
}

TEST_CASE("BSDFs are reciprocal, but for the scale of radiance in media", "[bsdf]") {
  for (const Named& named : rough_materials()) {
    const MaterialTable<double> table({named.material});
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const auto u = sample_block(SamplerKind::independent, 9, i, 0);
      const auto sphere = [](double a, double b) {
        return spherical(1 - 2 * a, 4 * a * (1 - a), 2 * pi<double> * b);
      };
      const Vec3d a = sphere(u[0], u[1]), b = sphere(u[2], u[3]);
      const auto medium2 = [&](const Vec3d& w) {
        const bool inside = named.material.type == MaterialType::dielectric && w.z < 0;
        return inside ? named.material.ior * named.material.ior : 1.0;
      };
      const double forth = table[0].evaluate(a, b).y / medium2(a),
                   back = table[0].evaluate(b, a).y / medium2(b);
      CAPTURE(named.name, i);
      REQUIRE(forth == Approx(back).epsilon(1e-9).margin(1e-12));
    }
  }
}

// 10 angles, 5 widths, 4 materials, 3 channels: 600 z-tests at 5 sigma, a false alarm once in 3000 seeds.
TEST_CASE("albedo by sampling equals albedo by quadrature", "[bsdf]") {
  for (const double alpha : {0.1, 0.2, 0.4, 0.7, 1.0})
    for (const Material& material :
         {conductor(alpha), rough_gold(alpha), microfacet(alpha), principled(alpha)}) {
      const MaterialTable<double> exact({material});
      const MaterialTable<float> table({material});
      for (int angle = 0; angle < 10; ++angle) {
        const double theta = (angle + 0.2) / 10 * pi<double> / 2;
        Mean mean[3];
        for (std::uint64_t i = 0; i < 20000; ++i) {
          const auto sample =
              draw(table[0], direction(static_cast<float>(theta), 1.f), static_cast<std::uint32_t>(angle), i);
          for (int c = 0; c < 3; ++c) mean[c].add(sample.weight[c]);
        }
        const Vec3d albedo = albedo_by_quadrature(exact[0], theta);
        for (int c = 0; c < 3; ++c) {
          CAPTURE(alpha, static_cast<int>(material.type), angle, c);
          CHECK(std::abs(mean[c].mean() - albedo[c]) <
                5 * mean[c].error() + 1e-4);  // quadrature is good to 1e-4
        }
      }
    }
}

TEST_CASE("no BSDF reflects more than it receives", "[bsdf]") {
  for (const double alpha : {0.1, 0.2, 0.4, 0.7, 1.0})
    for (const double ks : {0.0, 0.04, 1.0}) {
      const MaterialTable<double> table({microfacet(alpha, 1, ks)});
      for (int angle = 0; angle < 10; ++angle) {
        const Vec3d albedo = albedo_by_quadrature(table[0], (angle + 0.2) / 10 * pi<double> / 2);
        CAPTURE(alpha, ks, angle, albedo.x);
        CHECK(max_component(albedo) <= 1 + 1e-5);
        CHECK(albedo.x == Approx(1).margin(1e-3));  // kd = 1: the base reflects all that the lobe leaves
      }
    }
}

TEST_CASE("no base below a lobe that is not round reflects more than it leaves, at any azimuth", "[bsdf]") {
  for (const double alpha : {0.15, 0.5})
    for (const double ks : {0.04, 0.5})
      for (const double anisotropy : {0.5, 0.95}) {
        Material m{
            .name = {}, .type = MaterialType::principled, .kd = Vec3d(1), .ks = Vec3d(ks), .alpha = alpha};
        m.anisotropy = anisotropy;
        const MaterialTable<double> table({m});
        for (const double theta : {0.1, 0.8, 1.3, 1.5})
          for (const double phi : {0.0, 0.2, 0.6, 1.0, 1.5}) {
            const double albedo = albedo_of_white(table[0], direction(theta, phi));
            CAPTURE(alpha, ks, anisotropy, theta, phi, albedo);
            CHECK(albedo <= 1 + 2e-3);
            CHECK(
                albedo >=
                (theta < 1 ? 0.93 : 0.37));  // at grazing angles what some azimuth reflects is lost to others
          }
      }
}

TEST_CASE("no base does so where an image says how far from round the lobe is", "[bsdf]") {
  for (const double alpha : {0.15, 0.5}) {
    Material m{
        .name = {}, .type = MaterialType::principled, .kd = Vec3d(1), .ks = Vec3d(0.2), .alpha = alpha};
    m.anisotropy = 0.95;
    m.map(SurfaceParameter::anisotropy).texture = 0;
    const MaterialTable<double> table({m});
    for (const double anisotropy : {0.0, 0.2, 0.5, 0.8, 0.95}) {
      SurfaceValues<double> values(m);
      values.at(slot_anisotropy) = anisotropy;
      const Bsdf<double> bsdf = table.at(0, values);
      for (const double theta : {0.1, 0.8, 1.3, 1.5})
        for (const double phi : {0.0, 0.8, 1.5}) {
          const double albedo = albedo_of_white(bsdf, direction(theta, phi));
          CAPTURE(alpha, anisotropy, theta, phi, albedo);
          CHECK(albedo <= 1 + 2e-3);
          CHECK(albedo >= (theta < 1 ? 0.83 : 0.3));
        }
    }
  }
}
