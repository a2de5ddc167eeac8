#include "scene/polygon.h"

#include <cmath>
#include <numeric>

namespace castray {

namespace {

struct Point2 {
  double x, y;
  friend bool operator==(const Point2&, const Point2&) = default;
};

double twice_area(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Newell's normal: its length is twice the polygon's area, its components those of the projections.
Vec3d newell_normal(const std::vector<Vec3d>& corners) {
  Vec3d normal;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = corners[i] - corners[0], b = corners[(i + 1) % corners.size()] - corners[0];
    normal += cross(a, b);
  }
  return normal;
}

/// The polygon in the coordinate plane it is seen largest in, turning counter-clockwise.
std::vector<Point2> project(const std::vector<Vec3d>& corners) {
  const Vec3d n = newell_normal(corners);
  const int axis = std::abs(n.x) > std::abs(n.y) ? (std::abs(n.x) > std::abs(n.z) ? 0 : 2)
                                                 : (std::abs(n.y) > std::abs(n.z) ? 1 : 2);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<Point2> points;
  points.reserve(corners.size());
  for (const Vec3d& p : corners) points.push_back(n[axis] >= 0 ? Point2{p[u], p[v]} : Point2{p[v], p[u]});
  return points;
}

/// A polygon being cut: a ring of the corners that are left.
class Ring {
 public:
  explicit Ring(std::vector<Point2> points)
      : points_(std::move(points)), next_(points_.size()), last_(points_.size()) {
    for (std::uint32_t i = 0; i < size(); ++i) {
      next_[i] = (i + 1) % size();
      last_[next_[i]] = i;
    }
    for (std::uint32_t i = 0; i < size(); ++i)
      if (!is_convex(i)) reflex_.push_back(i);
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }
  std::uint32_t next(std::uint32_t i) const { return next_[i]; }
  std::uint32_t last(std::uint32_t i) const { return last_[i]; }

  /// Whether corner i can be cut off: it is convex and no other corner lies in its triangle. Only reflex
  /// corners need a look: a convex one inside brings a reflex one with it.
  bool is_ear(std::uint32_t i) {
    if (!is_convex(i)) return false;
    std::erase_if(reflex_,
                  [&](std::uint32_t k) { return is_convex(k); });  // cutting only ever makes them convex
    const Point2 &a = points_[last_[i]], &b = points_[i], &c = points_[next_[i]];
    for (std::uint32_t k : reflex_) {
      const Point2& p = points_[k];
      if (p == a || p == b || p == c) continue;
      if (twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 && twice_area(c, a, p) >= 0) return false;
    }
    return true;
  }

  void cut(std::uint32_t i) {
    next_[last_[i]] = next_[i];
    last_[next_[i]] = last_[i];
    std::erase(reflex_, i);
  }

 private:
  bool is_convex(std::uint32_t i) const {
    return twice_area(points_[last_[i]], points_[i], points_[next_[i]]) > 0;
  }

  std::vector<Point2> points_;
  std::vector<std::uint32_t> next_, last_;
  std::vector<std::uint32_t> reflex_;
};

}  // namespace

void triangulate(const std::vector<Vec3d>& corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Ring ring(project(corners));
  std::uint32_t i = 1, tried = 0;  // of a convex quad: (0,1,2) and (0,2,3)
  for (std::uint32_t left = ring.size(); left > 3;) {
    // Where no corner is an ear the polygon is not simple: cut anywhere.
    if (ring.is_ear(i) || tried > left) {
      triangles.push_back({ring.last(i), i, ring.next(i)});
      ring.cut(i);
      --left;
      tried = 0;
      i = ring.next(ring.next(i));  // not the neighbour: fans have thinner triangles
    } else {
      i = ring.next(i);
      ++tried;
    }
  }
  triangles.push_back({ring.next(i), ring.last(i), i});
}

}  // namespace castray
