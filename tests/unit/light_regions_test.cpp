#include "lights/light_regions.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <random>

#include "integrators.h"
#include "plan/plan.h"
#include "test_scenes.h"
#include "wavefront/try_lights.h"

using namespace castray;
using namespace castray::test;

namespace {

/// Places uniform in [-1,1]^3 at which each of `nodes` lights is looked for; `sees` says whether one is seen.
template <class Sees>
std::vector<LightTrial> trials(std::size_t count, const std::vector<float>& potentials, Sees sees) {
  std::mt19937 engine(11);
  std::uniform_real_distribution<float> number(-1, 1);
  std::vector<LightTrial> all(count);
  for (LightTrial& t : all) {
    t.place = {number(engine), number(engine), number(engine)};
    for (std::uint32_t node = 0; node < potentials.size(); ++node) {
      t.potential[node] = potentials[node];
      t.tested |= 1u << node;
      if (sees(node, t.place, number(engine))) t.seen |= 1u << node;
    }
  }
  return all;
}

double seen(const LightRegionTable& table, const Vec3f& place, std::size_t node) {
  return double{table.view().seen[table.region_at(place) * most_light_cut + node]};
}

}  // namespace

TEST_CASE("light regions find the wall between two rooms") {
  // a lamp in each room, the one beyond x = 0.3 a thousand times brighter
  const auto sees = [](std::uint32_t node, const Vec3f& x, float) { return (x.x > 0.3f) == (node == 1); };
  const LightRegionTable table(trials(4000, {1, 1000}, sees), {1. / 1001, 1000. / 1001});
  CHECK(table.regions() == 2);
  for (const Vec3f& place : {Vec3f(-0.9f, 0.5f, 0), Vec3f(0.28f, -0.7f, 0.9f)}) {
    CHECK(seen(table, place, 0) == 1);
    CHECK(seen(table, place, 1) == 0);
  }
  CHECK(seen(table, {0.32f, 0.9f, -0.9f}, 0) == 0);
  CHECK(seen(table, {0.32f, 0.9f, -0.9f}, 1) == 1);
  // in the dim room bounds find the lamp once in 1001 samples; dark places count less than bright ones
  const double dim = 0.65, bright = 1 - dim, mean = dim + bright * 1000;
  const double dim_weight = dim / (1 + 0.01 * mean * mean), bright_weight = bright / (1 + 1e-8 * mean * mean);
  const double without = dim_weight * 1001 + bright_weight * 1.001,
               with = (dim_weight + bright_weight) / double{learned_share};
  CHECK(table.gain() == Approx(without / with).epsilon(0.06));
}

TEST_CASE("light regions do not split by chance, and lights that are seen alike bring no gain") {
  const auto sees = [](std::uint32_t, const Vec3f&, float u) { return u < 0; };
  const LightRegionTable table(trials(4000, std::vector<float>(16, 1.f), sees),
                               std::vector<double>(16, 1. / 16));
  CHECK(table.regions() == 1);
  CHECK(table.gain() == Approx(1).epsilon(0.02));
  for (std::size_t node = 0; node < 16; ++node)
    CHECK(seen(table, {}, node) == Approx(std::sqrt(.5)).epsilon(.05));
}

TEST_CASE("without trials light regions know nothing") {
  const LightRegionTable table({}, {0.25, 0.75});
  CHECK(table.regions() == 1);
  CHECK(table.gain() == 1);
  CHECK(seen(table, {}, 0) == 1);
  CHECK(table.view().density[0] == 1);
}

TEST_CASE("in each region the densities of light samples, by power, are those of probabilities") {
  const auto sees = [](std::uint32_t node, const Vec3f& x, float u) {
    return node == 2 ? u < x.y : (x.x > 0.3f) == (node == 1);
  };
  const std::vector<double> powers = {0.1, 0.6, 0.3};
  const LightRegionTable table(trials(4000, {1, 6, 3}, sees), powers);
  REQUIRE(table.regions() > 2);
  for (std::size_t region = 0; region < table.regions(); ++region) {
    double sum = 0;
    for (std::size_t node = 0; node < powers.size(); ++node) {
      const double density = double{table.view().density[region * most_light_cut + node]};
      CHECK(density >= 1 - learned_share - 1e-6);  // bounds here are in proportion to power
      sum += density * powers[node];
    }
    CHECK(sum == Approx(1));
  }
}

namespace {

/// A scene's kernel data with the regions learned.
struct Learned {
  explicit Learned(const Scene& scene)
      : data(scene, make_plan(scene, {}, {64, 64, 0, 0, 64, 64}), 64, 64, 1) {
    const LightRegionTable table(try_lights(scene, choose_kernel("auto"), data, 64, 64, 1),
                                 data.lights.power_shares());
    regions = table.regions();
    data.use(table, scene);
  }
  KernelSceneData data;
  std::size_t regions = 0;
};

struct Frequencies {
  std::map<std::uint32_t, double> probability, count;
  double found = 0;  ///< choices of a light; bounds of a node may promise light that none below it brings
};

/// Which lights are chosen for a point, and with what probabilities.
Frequencies choose(const std::string& isa, const LightList& list, const Vec3f& p, const Vec3f& n,
                   std::uint32_t count) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> number(0, 1);
  std::vector<float> u(count), deep(count), probability(count);
  std::vector<std::uint32_t> light(count);
  for (float& v : u) v = std::min(number(engine), 0x1.fffffep-1f);
  for (float& v : deep) v = std::min(number(engine), 0x1.fffffep-1f);
  choose_kernel(isa).choose_lights(
      list,
      {{p.x, p.y, p.z}, {n.x, n.y, n.z}, count, u.data(), deep.data(), light.data(), probability.data()});
  Frequencies f;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(probability[i] > 0)) continue;
    f.probability[light[i]] = double{probability[i]};
    ++f.count[light[i]];
    ++f.found;
  }
  return f;
}

/// Probabilities are the frequencies, by Pearson's chi-square, at a false-alarm rate below 1e-4; and sum
/// to 1.
void check_frequencies(const Frequencies& f, double count) {
  double chi2 = 0, sum = 0;
  int cells = 0;
  for (const auto& [light, probability] : f.probability) {
    sum += probability;
    const double expected = probability * count;
    if (expected < 10) continue;
    chi2 += (f.count.at(light) - expected) * (f.count.at(light) - expected) / expected;
    ++cells;
  }
  CHECK(sum == Approx(f.found / count).margin(0.006));  // lights that were never chosen are missing
  CHECK(chi2 < cells + 4 * std::sqrt(2.0 * cells) + 16);
}

}  // namespace

TEST_CASE("the lamp of a sealed room is seldom chosen from beside it, but sometimes") {
  const Scene scene = standard_scene("kinds/bright_neighbour");
  const Learned learned(scene);
  const LightList& list = learned.data.view.lights;
  REQUIRE(list.regions.tree);
  LightList bounds_only = list;
  bounds_only.regions = {};
  const Vec3f floor(scene.to_scene({0.5, 0.001, 1.0})), up(0, 1, 0);
  const bool first_is_dim = list.lights[0].emission[0] < list.lights[1].emission[0];
  const std::uint32_t dim = first_is_dim ? 0 : 1, bright = 1 - dim;
  constexpr std::uint32_t count = 100000;
  for (const std::string& isa : instruction_sets()) {
    CAPTURE(isa);
    Frequencies known = choose(isa, list, floor, up, count),
                unknown = choose(isa, bounds_only, floor, up, count);
    check_frequencies(known, count);
    check_frequencies(unknown, count);
    CHECK(unknown.probability[dim] < 0.02);
    CHECK(known.probability[dim] == Approx(learned_share).margin(0.02));
    CHECK(known.probability[bright] ==
          Approx((1 - learned_share) * unknown.probability[bright]).margin(1e-4));
    CHECK(known.count[bright] > 0);
  }
}

TEST_CASE("probabilities of a choice among many lights are its frequencies, regions known or not") {
  const Scene scene = standard_scene("kinds/rooms_of_lamps");
  const Learned learned(scene);
  LightList bounds_only = learned.data.view.lights;
  bounds_only.regions = {};
  constexpr std::uint32_t count = 200000;
  const Vec3f p(scene.camera.position), up(0, 1, 0), aside(0.8f, 0.6f, 0);
  for (const std::string& isa : instruction_sets())
    for (const LightList& list : {learned.data.view.lights, bounds_only})
      for (const Vec3f& normal : {up, aside}) {
        CAPTURE(isa, normal.y, list.regions.tree != nullptr);
        check_frequencies(choose(isa, list, p, normal, count), count);
      }
}

TEST_CASE("trials of lights do not depend on threads, and see what is there") {
  const Scene scene = standard_scene("kinds/bright_neighbour");
  const Learned learned(scene);
  const auto one = try_lights(scene, choose_kernel("auto"), learned.data, 64, 64, 1);
  const auto three = try_lights(scene, choose_kernel("auto"), learned.data, 64, 64, 3);
  REQUIRE(one.size() == three.size());
  REQUIRE(one.size() > 500);
  const bool first_is_dim =
      learned.data.lights.lights()[0].emission[0] < learned.data.lights.lights()[1].emission[0];
  std::size_t dim_seen = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    CHECK(
        (one[i].place == three[i].place && one[i].tested == three[i].tested && one[i].seen == three[i].seen));
    CHECK((one[i].seen & (first_is_dim ? 2u : 1u)) == 0);  // the neighbour's, behind two walls
    dim_seen += one[i].seen != 0;
  }
  CHECK(static_cast<double>(dim_seen) > 0.6 * static_cast<double>(one.size()));
}
