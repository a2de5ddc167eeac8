#include "scene/polygon.h"

#include <algorithm>
#include <cmath>

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
  for (std::size_t i = 0; i < corners.size(); ++i)
    normal += cross(corners[i], corners[(i + 1) % corners.size()]);
  return normal;
}

/// The corners seen from the first, in units of the farthest's greatest coordinate. Empty where that is not
/// finite or 0.
std::vector<Vec3d> normalized(const std::vector<Vec3d>& corners) {
  std::vector<Vec3d> result;
  double farthest = 0;
  for (const Vec3d& p : corners) {
    const Vec3d q = p - corners.front();
    if (!is_finite(q)) return {};
    farthest = std::max({farthest, std::abs(q.x), std::abs(q.y), std::abs(q.z)});
    result.push_back(q);
  }
  if (farthest == 0) return {};
  for (Vec3d& q : result) q = q / farthest;
  return result;
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

/// Corners by place, so that only those near a triangle need a look. Coordinates are in [-1,1].
class CornerGrid {
 public:
  explicit CornerGrid(std::size_t count)
      : side_(static_cast<int>(std::clamp(std::sqrt(static_cast<double>(count)), 1.0, 1024.0))),
        cells_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_)) {}

  void add(std::uint32_t corner, const Point2& p) { cell(column(p.x), column(p.y)).push_back(corner); }

  /// Whether `test` is true for a cell that the box low..high touches.
  template <class Test>
  bool any_cell(const Point2& low, const Point2& high, const Test& test) {
    for (int y = column(low.y); y <= column(high.y); ++y)
      for (int x = column(low.x); x <= column(high.x); ++x)
        if (test(cell(x, y))) return true;
    return false;
  }

 private:
  int column(double x) const { return std::clamp(static_cast<int>((x + 1) * 0.5 * side_), 0, side_ - 1); }
  std::vector<std::uint32_t>& cell(int x, int y) { return cells_[static_cast<std::size_t>(y * side_ + x)]; }

  int side_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

/// A polygon being cut: a ring of the corners that are left.
class Ring {
 public:
  explicit Ring(std::vector<Point2> points)
      : points_(std::move(points)), next_(points_.size()), last_(points_.size()), reflex_(points_.size()) {
    for (std::uint32_t i = 0; i < size(); ++i) {
      next_[i] = (i + 1) % size();
      last_[next_[i]] = i;
    }
    for (std::uint32_t i = 0; i < size(); ++i)
      if (!is_convex(i)) reflex_.add(i, points_[i]);
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }
  std::uint32_t next(std::uint32_t i) const { return next_[i]; }
  std::uint32_t last(std::uint32_t i) const { return last_[i]; }

  /// Whether corner i can be cut off: it is convex and no other corner lies in its triangle. Only reflex
  /// corners need a look: a convex one inside brings a reflex one with it.
  bool is_ear(std::uint32_t i) {
    if (!is_convex(i)) return false;
    const Point2 &a = points_[last_[i]], &b = points_[i], &c = points_[next_[i]];
    const auto blocks = [&](std::uint32_t k) {
      const Point2& p = points_[k];
      if (p == a || p == b || p == c) return false;
      return twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 && twice_area(c, a, p) >= 0;
    };
    const Point2 low{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})};
    const Point2 high{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})};
    return !reflex_.any_cell(low, high, [&](std::vector<std::uint32_t>& cell) {
      std::erase_if(cell,
                    [&](std::uint32_t k) { return is_cut(k) || is_convex(k); });  // cutting makes them convex
      return std::ranges::any_of(cell, blocks);
    });
  }

  void cut(std::uint32_t i) {
    next_[last_[i]] = next_[i];
    last_[next_[i]] = last_[i];
    next_[i] = i;
  }

 private:
  bool is_cut(std::uint32_t i) const { return next_[i] == i; }
  bool is_convex(std::uint32_t i) const {
    return twice_area(points_[last_[i]], points_[i], points_[next_[i]]) > 0;
  }

  std::vector<Point2> points_;
  std::vector<std::uint32_t> next_, last_;
  CornerGrid reflex_;
};

}  // namespace

void triangulate(const std::vector<Vec3d>& corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const std::vector<Vec3d> scaled = normalized(corners);
  if (scaled.empty()) {
    for (std::uint32_t i = 2; i < corners.size(); ++i) triangles.push_back({0, i - 1, i});
    return;
  }
  Ring ring(project(scaled));
  std::uint32_t i = 1, tried = 0;  // of a convex quad: (0,1,2) and (0,2,3)
  for (std::uint32_t left = ring.size(); left > 3;) {
    // Where no corner is an ear the polygon is not simple: cut anywhere.
    if (ring.is_ear(i) || tried > left) {
      const std::uint32_t after = ring.next(i);
      triangles.push_back({ring.last(i), i, after});
      ring.cut(i);
      --left;
      tried = 0;
      i = ring.next(after);  // not the neighbour: fans have thinner triangles
    } else {
      i = ring.next(i);
      ++tried;
    }
  }
  triangles.push_back({ring.next(i), ring.last(i), i});
}

}  // namespace castray
