#include "generate/leaves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/frame.h"
#include "generate/random.h"

namespace castray {

namespace {

using std::numbers::pi;

constexpr std::uint32_t segments = 5;  ///< of each side of the outline, from stalk to tip
static_assert(triangles_of_cut_leaf == 2 * segments - 2);

/// Half the leaf's width at the place `t` of its length, both in [0,1]: straight between the segments' ends.
double half_width(double t) {
  const auto at_end = [](double end) { return 0.45 * std::sin(pi * end / segments); };
  const double low = std::floor(t * segments), s = t * segments - low;
  return at_end(low) * (1 - s) + at_end(low + 1) * s;
}

/// A leaf's square: its lower left corner and its sides.
struct Place {
  Vec3d corner, across, along;
  Vec3d at(double u, double v) const { return corner + across * u + along * v; }
};

/// Anywhere in a ball, more of them near its surface, turned to all sides but upwards rather than down.
/// Together the leaves cover the crown about three times over, however many they are.
Place place_leaf(std::uint32_t leaves, Random& random) {
  const double size = std::min(0.5, 4 / std::sqrt(static_cast<double>(leaves)));
  const Vec3d direction = random.on_sphere();
  const Vec3d center = direction * ((1 - size) * std::sqrt(random.next()));
  const Vec3d tilted = random.on_sphere() + Vec3d{0, 0.8, 0};
  const Frame<double> frame = make_frame(normalize(tilted));
  const double turn = 2 * pi * random.next();
  const Vec3d across = (frame.tangent * std::cos(turn) + frame.bitangent * std::sin(turn)) * size;
  const Vec3d along = (frame.bitangent * std::cos(turn) - frame.tangent * std::sin(turn)) * size;
  return {center - (across + along) * 0.5, across, along};
}

void add_square(Shape& shape, const Place& leaf) {
  const auto first = static_cast<std::uint32_t>(shape.positions.size());
  for (const auto& [u, v] :
       {std::pair(0.f, 0.f), std::pair(1.f, 0.f), std::pair(1.f, 1.f), std::pair(0.f, 1.f)}) {
    shape.positions.push_back(leaf.at(u, v));
    shape.uvs.push_back({u, v});
  }
  shape.triangles.push_back({first, first + 1, first + 2});
  shape.triangles.push_back({first, first + 2, first + 3});
}

/// A strip from the stalk, one point, over pairs of points to the tip.
void add_outline(Shape& shape, const Place& leaf) {
  const auto first = static_cast<std::uint32_t>(shape.positions.size());
  shape.positions.push_back(leaf.at(0.5, 0));
  for (std::uint32_t k = 1; k < segments; ++k) {
    const double t = static_cast<double>(k) / segments, w = half_width(t);
    shape.positions.push_back(leaf.at(0.5 - w, t));
    shape.positions.push_back(leaf.at(0.5 + w, t));
  }
  shape.positions.push_back(leaf.at(0.5, 1));
  shape.triangles.push_back({first, first + 2, first + 1});
  for (std::uint32_t k = 1; k + 1 < segments; ++k) {
    const std::uint32_t left = first + 2 * k - 1;
    shape.triangles.push_back({left, left + 1, left + 3});
    shape.triangles.push_back({left, left + 3, left + 2});
  }
  const std::uint32_t last = first + 2 * segments - 3;
  shape.triangles.push_back({last, last + 1, last + 2});
}

Shape crown(std::uint32_t leaves, std::uint32_t seed, void (*add)(Shape&, const Place&)) {
  Random random(seed);
  Shape shape;
  for (std::uint32_t i = 0; i < leaves; ++i) add(shape, place_leaf(leaves, random));
  return shape;
}

}  // namespace

Shape masked_leaves(std::uint32_t leaves, std::uint32_t seed) { return crown(leaves, seed, add_square); }

Shape cut_leaves(std::uint32_t leaves, std::uint32_t seed) { return crown(leaves, seed, add_outline); }

Image leaf_mask(int size) {
  constexpr int side = 8;  // of the grid of points in a texel
  Image mask(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      int inside = 0;
      for (int i = 0; i < side * side; ++i) {
        const double u = (x + (i % side + 0.5) / side) / size, v = 1 - (y + (i / side + 0.5) / side) / size;
        inside += std::abs(u - 0.5) < half_width(v);
      }
      mask.at(x, y) = Vec3f(static_cast<float>(inside) / (side * side));
    }
  return mask;
}

}  // namespace castray
