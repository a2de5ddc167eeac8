#include "geometry/presplit.h"

#include <bit>
#include <numeric>

namespace castray {
namespace {

constexpr std::uint32_t chunk_size = 1 << 14;

/// Numbers that are sure to enclose `x`.
float below(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}
float above(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

struct Box {
  Vec3f lower, upper;
};

/// A plane across an axis.
struct Plane {
  int axis;
  float position;
  int level;  ///< 0 halves the scene, 1 its halves, ...
};

class Presplitter {
 public:
  Presplitter(const MeshView& mesh, const Box& scene) : mesh_(mesh), scene_(scene) {
    const Vec3f extent = scene.upper - scene.lower;
    size_ = std::max(extent.x, std::max(extent.y, extent.z));
  }

  /// How much a cut would save, on a scale of its own.
  float priority(std::uint32_t triangle) const {
    const Box box = box_of(triangle);
    const float area = half_area({load_point(box.lower), load_point(box.upper)});
    const float saved = std::ldexp(area - least_half_area(mesh_, triangle), -best_plane(box).level);
    return saved > 0 && std::isfinite(saved) ? std::cbrt(saved) : 0;
  }

  void split(std::uint32_t triangle, std::uint32_t cuts, std::vector<PrimRef>& out) const {
    split(triangle, box_of(triangle), cuts, out);
  }

 private:
  Box box_of(std::uint32_t triangle) const {
    const Bounds box = triangle_bounds(mesh_, triangle);
    return {to_vec3(box.lower), to_vec3(box.upper)};
  }

  /// Of the planes that halve the scene, its halves, and so on, the first that cuts the box: as the upper
  /// levels of the hierarchy are likely to.
  Plane best_plane(const Box& box) const {
    Plane best{-1, 0, 31};
    float longest = -1;
    for (int axis = 0; axis < 3; ++axis) {
      const double scale = 0x1p30 / size_;
      const auto a = static_cast<std::uint32_t>((double(box.lower[axis]) - scene_.lower[axis]) * scale);
      const auto b = static_cast<std::uint32_t>((double(box.upper[axis]) - scene_.lower[axis]) * scale);
      if (a == b) continue;
      const int bit = std::bit_width(a ^ b) - 1, level = 30 - bit;
      const auto position = static_cast<float>(scene_.lower[axis] + (b >> bit << bit) / scale);
      const float length = box.upper[axis] - box.lower[axis];
      if (!(position > box.lower[axis] && position < box.upper[axis])) continue;
      if (level < best.level || (level == best.level && length > longest))
        best = {axis, position, level}, longest = length;
    }
    return best;
  }

  void split(std::uint32_t triangle, const Box& box, std::uint32_t cuts, std::vector<PrimRef>& out) const {
    const Plane plane = cuts > 0 ? best_plane(box) : Plane{-1, 0, 0};
    Box left, right;
    if (plane.axis < 0 || !cut(triangle, box, plane, left, right)) {
      out.emplace_back(Bounds{load_point(box.lower), load_point(box.upper)}, triangle);
      return;
    }
    const auto longest = [](const Box& b) {
      const Vec3f d = b.upper - b.lower;
      return std::max(d.x, std::max(d.y, d.z));
    };
    const double share = longest(left) / (static_cast<double>(longest(left)) + longest(right));
    const auto left_cuts = static_cast<std::uint32_t>((cuts - 1) * share + 0.5);
    split(triangle, left, left_cuts, out);
    split(triangle, right, cuts - 1 - left_cuts, out);
  }

  /// The boxes of the triangle's parts on both sides of the plane, within `box`. False if one side is empty.
  bool cut(std::uint32_t triangle, const Box& box, const Plane& plane, Box& left, Box& right) const {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    left = right = {Vec3f(infinity), Vec3f(-infinity)};
    const auto add = [](Box& b, int axis, double low, double high) {
      b.lower[axis] = std::min(b.lower[axis], below(low));
      b.upper[axis] = std::max(b.upper[axis], above(high));
    };
    const double position = plane.position;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d p(mesh_.positions[mesh_.triangles[triangle][i]]);
      const Vec3d q(mesh_.positions[mesh_.triangles[triangle][(i + 1) % 3]]);
      const double p_side = p[plane.axis] - position, q_side = q[plane.axis] - position;
      for (int axis = 0; axis < 3; ++axis) {
        if (p_side <= 0) add(left, axis, p[axis], p[axis]);
        if (p_side >= 0) add(right, axis, p[axis], p[axis]);
        if (p_side * q_side < 0) {
          const double x = p[axis] + (q[axis] - p[axis]) * (p_side / (p_side - q_side));
          add(left, axis, x, x);
          add(right, axis, x, x);
        }
      }
    }
    left.upper[plane.axis] = std::min(left.upper[plane.axis], plane.position);
    right.lower[plane.axis] = std::max(right.lower[plane.axis], plane.position);
    for (Box* side : {&left, &right}) {
      for (int axis = 0; axis < 3; ++axis) {
        side->lower[axis] = std::max(side->lower[axis], box.lower[axis]);
        side->upper[axis] = std::min(side->upper[axis], box.upper[axis]);
        if (!(side->lower[axis] <= side->upper[axis])) return false;
      }
    }
    return true;
  }

  MeshView mesh_;
  Box scene_;
  float size_;
};

/// The factor by which priorities become numbers of cuts, of which there shall be at most `budget`.
double scale_of_priorities(const std::vector<float>& priorities, double budget) {
  double sum = 0;
  for (const float p : priorities) sum += static_cast<double>(p);
  if (!(sum > 0)) return 0;
  double low = budget / sum, high = 64 * low;  // rounding down leaves some of the budget at `low`
  for (int i = 0; i < 12; ++i) {
    const double middle = (low + high) / 2;
    double cuts = 0;
    for (const float p : priorities) cuts += std::floor(static_cast<double>(p) * middle);
    (cuts <= budget ? low : high) = middle;
  }
  return low;
}

}  // namespace

std::vector<PrimRef> presplit(const MeshView& mesh, double share, int threads) {
  Bounds scene;
  for (std::uint32_t i = 0; i < mesh.count; ++i) scene.add(triangle_bounds(mesh, i));
  const Presplitter splitter(mesh, {to_vec3(scene.lower), to_vec3(scene.upper)});
  std::vector<float> priorities(mesh.count);
#pragma omp parallel for num_threads(threads)
  for (std::uint32_t i = 0; i < mesh.count; ++i) priorities[i] = splitter.priority(i);
  const double scale = scale_of_priorities(priorities, share * mesh.count);

  const std::uint32_t chunks = (mesh.count + chunk_size - 1) / chunk_size;
  std::vector<std::vector<PrimRef>> parts(chunks);
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (std::uint32_t c = 0; c < chunks; ++c) {
    const std::uint32_t end = std::min(mesh.count, (c + 1) * chunk_size);
    for (std::uint32_t i = c * chunk_size; i < end; ++i) {
      splitter.split(i, static_cast<std::uint32_t>(static_cast<double>(priorities[i]) * scale), parts[c]);
    }
  }
  std::vector<PrimRef> refs;
  refs.reserve(std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                               [](std::size_t sum, auto& part) { return sum + part.size(); }));
  for (std::vector<PrimRef>& part : parts) {
    refs.insert(refs.end(), part.begin(), part.end());
    part = {};
  }
  return refs;
}

}  // namespace castray
