#include "generate/forest.h"

#include <cmath>
#include <numbers>

#include "core/frame.h"
#include "generate/random.h"

namespace castray {

namespace {

constexpr double spacing = 5;

double ground_height(double x, double z) {
  return 1.5 * std::sin(0.05 * x + 1) * std::cos(0.04 * z) + 0.5 * std::sin(0.13 * z + 0.11 * x);
}

/// Half the side of the square that holds so many trees.
double reach_of(std::uint32_t trees) { return spacing * std::sqrt(static_cast<double>(trees)) / 2; }

class TreeGrower {
 public:
  TreeGrower(std::uint32_t triangles, std::uint32_t seed) : random_(seed) {
    const double ends = std::pow(children, levels);
    const double wood = triangles / 5., leaves = triangles - wood;
    // a branch of every level but the first is one of `children` times as many
    const double branches = (ends * children - 1) / (children - 1);
    sides_ = std::max(3u, static_cast<std::uint32_t>(wood / branches / 2));
    leaves_ = std::max(1u, static_cast<std::uint32_t>(leaves / ends / 2));
  }

  Tree grow() {
    branch({}, {0, 1, 0}, 4, 0.25, 0);
    return std::move(tree_);
  }

 private:
  static constexpr int levels = 4;
  static constexpr std::uint32_t children = 5;

  void branch(const Vec3d& from, const Vec3d& direction, double length, double radius, int level) {
    const Vec3d to = from + direction * length;
    add_tube(from, to, radius, radius * 0.6);
    if (level == levels) return add_leaves(from, to);
    for (std::uint32_t child = 0; child < children; ++child) {
      const double along = 0.45 + 0.55 * (child + random_.next()) / children;
      const double around = 2.4 * child + random_.next(), away = 0.5 + 0.4 * random_.next();
      const Vec3d local{std::sin(away) * std::cos(around), std::sin(away) * std::sin(around), std::cos(away)};
      const Vec3d turned = make_frame(direction).to_world(local);
      branch(from + direction * (length * along), normalize(turned + Vec3d(0, 0.15, 0)),
             length * (0.5 + 0.2 * random_.next()), radius * 0.5, level + 1);
    }
  }

  void add_tube(const Vec3d& from, const Vec3d& to, double radius, double end_radius) {
    const Frame<double> frame = make_frame(normalize(to - from));
    Shape& wood = tree_.wood;
    const auto first = static_cast<std::uint32_t>(wood.positions.size());
    for (std::uint32_t i = 0; i < sides_; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides_;
      const Vec3d out = frame.to_world(Vec3d(std::cos(angle), std::sin(angle), 0));
      wood.positions.push_back(from + out * radius);
      wood.positions.push_back(to + out * end_radius);
    }
    for (std::uint32_t i = 0; i < sides_; ++i) {
      const std::uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % sides_);
      wood.triangles.push_back({a, b, b + 1});
      wood.triangles.push_back({a, b + 1, a + 1});
    }
  }

  /// Rhombs of two triangles, around the last branch.
  void add_leaves(const Vec3d& from, const Vec3d& to) {
    Shape& leaves = tree_.leaves;
    for (std::uint32_t i = 0; i < leaves_; ++i) {
      const Vec3d jitter = random_.on_sphere() * (0.35 * random_.next());
      const Vec3d foot = from + (to - from) * random_.next() + jitter;
      const Vec3d along = random_.on_sphere() * 0.12,
                  normal = make_frame(normalize(along)).to_world(Vec3d(1, 0, 0));
      const Vec3d across = cross(normal, along) * 0.4;
      const auto first = static_cast<std::uint32_t>(leaves.positions.size());
      for (const Vec3d& p : {foot, foot + along * 0.5 + across, foot + along, foot + along * 0.5 - across})
        leaves.positions.push_back(p);
      leaves.triangles.push_back({first, first + 1, first + 2});
      leaves.triangles.push_back({first, first + 2, first + 3});
    }
  }

  Random random_;
  std::uint32_t sides_, leaves_;
  Tree tree_;
};

}  // namespace

Tree make_tree(std::uint32_t triangles, std::uint32_t seed) { return TreeGrower(triangles, seed).grow(); }

std::vector<TreePlace> make_places(std::uint32_t trees, std::uint32_t seed) {
  Random random(seed);
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(trees))));
  std::vector<TreePlace> places;
  for (std::uint32_t i = 0; i < trees; ++i) {
    const double x = (i % side + 0.9 * random.next()) * spacing - reach_of(trees);
    const double z = (i / side + 0.9 * random.next()) * spacing - reach_of(trees);
    const double turn = 2 * std::numbers::pi * random.next();
    places.push_back({{x, ground_height(x, z), z}, turn, 0.7 + 0.6 * random.next()});
  }
  return places;
}

Shape make_ground(std::uint32_t trees) {
  constexpr std::uint32_t cells = 128;
  const double reach = reach_of(trees) + 6 * spacing;
  Shape ground;
  for (std::uint32_t row = 0; row <= cells; ++row)
    for (std::uint32_t column = 0; column <= cells; ++column) {
      const double x = (2. * column / cells - 1) * reach, z = (2. * row / cells - 1) * reach;
      ground.positions.push_back({x, ground_height(x, z), z});
    }
  for (std::uint32_t row = 0; row < cells; ++row)
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t a = row * (cells + 1) + column, b = a + cells + 1;
      ground.triangles.push_back({a, b, b + 1});
      ground.triangles.push_back({a, b + 1, a + 1});
    }
  return ground;
}

}  // namespace castray
