#include "lights/arrival_guide.h"

#include <catch2/catch.hpp>

#include "guide_bins.h"

using namespace castray;
using namespace castray::test;

namespace {

/// The probabilities of the bins at a place, after the tree's planes.
std::vector<double> probabilities(const ArrivalGuideTable& table, const Vec3f& p) {
  const RegionNode* node = table.tree;
  while ((node->link & 3) != region_leaf)
    node = table.tree + (node->link >> 2) + (p[static_cast<int>(node->link & 3)] >= node->plane ? 1 : 0);
  return probabilities_of(table.cumulative + std::size_t{node->link >> 2} * (guide_bins + 1));
}

/// Light along the middle of a square of the face +y of a cube.
struct Arriving {
  Vec3f w;
  std::size_t bin;
};
Arriving along(std::size_t a, std::size_t b) {
  return {normalize(Vec3f(middle_of_step(b), 1, middle_of_step(a))), guide_bin(2, a, b)};
}

/// `count` samples around a place, of one direction.
void add(std::vector<UsefulEmission>& samples, float x, const Vec3f& w, int count) {
  for (int i = 0; i < count; ++i)
    samples.push_back({Vec3f(x + static_cast<float>(i) * 0x1p-12f, 0, 0), w, 1.f});
}

}  // namespace

TEST_CASE("an arrival guide of too few samples is empty") {
  CHECK(!ArrivalGuide().table().tree);
  std::vector<UsefulEmission> samples;
  add(samples, 0, {0, 1, 0}, 10);
  CHECK(!ArrivalGuide(samples).table().tree);
}

TEST_CASE("an arrival guide knows where light comes from, and place by place what is likelier") {
  const Arriving left = along(1, 6), right = along(5, 2);
  std::vector<UsefulEmission> samples;
  add(samples, 0, left.w, 128);
  add(samples, 8, right.w, 128);
  const ArrivalGuide guide(samples);
  const std::vector<double> near = probabilities(guide.table(), {0.01f, 3, 0});
  const std::vector<double> far = probabilities(guide.table(), {8.01f, -2, 1});
  // Half of what is known is of the next larger box; the largest has both alike.
  CHECK(near[left.bin] == Approx(0.875).margin(1e-6));
  CHECK(near[right.bin] == Approx(0.125).margin(1e-6));
  CHECK(far[right.bin] == Approx(0.875).margin(1e-6));
  CHECK(far[left.bin] == Approx(0.125).margin(1e-6));
}

TEST_CASE("an arrival guide of samples in one place is one box") {
  const Arriving only = along(3, 3);
  const ArrivalGuide guide(std::vector<UsefulEmission>(1000, {Vec3f(1, 2, 3), only.w, 2.f}));
  CHECK((guide.table().tree->link & 3) == region_leaf);
  CHECK(probabilities(guide.table(), {0, 0, 0})[only.bin] == Approx(1).margin(1e-6));
}
