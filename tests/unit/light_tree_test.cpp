#include "lights/light_tree.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "castray/vec.h"

using namespace castray;

namespace {

std::vector<KernelLight> random_lights(std::size_t count) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> number(-1, 1);
  std::vector<KernelLight> lights(count);
  for (KernelLight& l : lights) {
    const Vec3f edge1{number(engine), number(engine), number(engine)},
        edge2{number(engine), number(engine), 0.5f};
    const Vec3f n = normalize(cross(edge1, edge2));
    for (int i = 0; i < 3; ++i) {
      l.origin[i] = number(engine);
      l.edge1[i] = edge1[i] * 0.1f;
      l.edge2[i] = edge2[i] * 0.1f;
      l.normal[i] = n[i];
      l.emission[i] = 1;
    }
    l.area = length(cross(edge1, edge2)) * 0.01f;
    l.two_sided = &l == &lights[0];
  }
  return lights;
}

Vec3d vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

/// Every light below a node is within its sphere and its cone; returns their power.
double check_node(const LightBounds& node, const std::vector<KernelLight>& lights,
                  const std::vector<LightBounds>& pairs, const std::vector<const LightBounds*>& above,
                  std::multiset<std::uint32_t>& met) {
  std::vector<const LightBounds*> path = above;
  path.push_back(&node);
  double power = 0;
  if (node.next >= light_leaf) {
    const std::uint32_t light = node.next - light_leaf;
    met.insert(light);
    const KernelLight& l = lights[light];
    for (const LightBounds* b : path) {
      for (int corner = 0; corner < 4; ++corner) {
        const Vec3d p = vec(l.origin) + vec(l.edge1) * (corner & 1) + vec(l.edge2) * (corner >> 1);
        CHECK(length(p - vec(b->center)) <= b->radius);
      }
      const double angle = std::acos(std::min(1.0, dot(vec(l.normal), vec(b->axis))));
      if (b->cos_spread > 0) CHECK(angle <= std::acos(b->cos_spread) + 1e-6);
      if (l.two_sided) CHECK(b->cos_spread <= 0);
    }
    power = l.area;
  } else {
    power = check_node(pairs[2 * node.next], lights, pairs, path, met) +
            check_node(pairs[2 * node.next + 1], lights, pairs, path, met);
  }
  CHECK(node.power == Approx(power).epsilon(1e-4));
  return power;
}

}  // namespace

TEST_CASE("a light tree holds every light once, within all bounds above it") {
  for (const std::size_t count : {1, 2, 3, 31, 32, 33, 64, 1000}) {
    const std::vector<KernelLight> lights = random_lights(count);
    const LightTree tree(lights, 2);
    CHECK(tree.cut().size() <= std::size_t{most_light_cut});
    CHECK(2 * tree.cut().size() > std::min<std::size_t>(count, most_light_cut));
    std::multiset<std::uint32_t> met;
    for (const LightBounds& node : tree.cut()) check_node(node, lights, tree.pairs(), {}, met);
    CHECK(met.size() == count);
    CHECK(std::set<std::uint32_t>(met.begin(), met.end()).size() == count);
  }
}

TEST_CASE("a light tree is the same for any number of threads") {
  const std::vector<KernelLight> lights = random_lights(20000);
  const LightTree one(lights, 1), two(lights, 2);
  CHECK(std::memcmp(one.pairs().data(), two.pairs().data(), one.pairs().size() * sizeof(LightBounds)) == 0);
}
