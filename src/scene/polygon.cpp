#include "scene/polygon.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

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

  void add(std::uint32_t corner, const Point2& p) {
    cell(column(p.x), column(p.y)).push_back(corner);
    all_.push_back(corner);
  }

  /// Whether `test` is true for one of the corners in cells that the box low..high touches, and maybe for
  /// others. Corners that are `gone` are forgotten.
  template <class Gone, class Test>
  bool any(const Point2& low, const Point2& high, const Gone& gone, const Test& test) {
    const int x0 = column(low.x), x1 = column(high.x), y0 = column(low.y), y1 = column(high.y);
    const auto any_of = [&](std::vector<std::uint32_t>& corners) {
      std::erase_if(corners, gone);
      return std::ranges::any_of(corners, test);
    };
    if (static_cast<std::size_t>(x1 - x0 + 1) * static_cast<std::size_t>(y1 - y0 + 1) > all_.size())
      return any_of(all_);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x)
        if (any_of(cell(x, y))) return true;
    return false;
  }

 private:
  int column(double x) const { return std::clamp(static_cast<int>((x + 1) * 0.5 * side_), 0, side_ - 1); }
  std::vector<std::uint32_t>& cell(int x, int y) { return cells_[static_cast<std::size_t>(y * side_ + x)]; }

  int side_;
  std::vector<std::vector<std::uint32_t>> cells_;
  std::vector<std::uint32_t> all_;
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
      if (is_reflex(i)) reflex_.add(i, points_[i]);
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }
  std::uint32_t next(std::uint32_t i) const { return next_[i]; }
  std::uint32_t last(std::uint32_t i) const { return last_[i]; }
  bool is_cut(std::uint32_t i) const { return next_[i] == i; }

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
    // Cutting makes reflex corners convex.
    const auto gone = [&](std::uint32_t k) { return is_cut(k) || !is_reflex(k); };
    return !reflex_.any(low, high, gone, blocks);
  }

  void cut(std::uint32_t i) {
    next_[last_[i]] = next_[i];
    last_[next_[i]] = last_[i];
    next_[i] = i;
  }

 private:
  double turn(std::uint32_t i) const { return twice_area(points_[last_[i]], points_[i], points_[next_[i]]); }
  bool is_convex(std::uint32_t i) const { return turn(i) > 0; }

  /// By more than the rounding of coordinates in [-1,1]: corners in a straight line are not, and block no
  /// ear.
  bool is_reflex(std::uint32_t i) const {
    const Point2 &a = points_[last_[i]], &b = points_[i], &c = points_[next_[i]];
    const double edges =
        std::abs(b.x - a.x) + std::abs(b.y - a.y) + std::abs(c.x - b.x) + std::abs(c.y - b.y);
    return turn(i) < -0x1p-51 * edges;
  }

  std::vector<Point2> points_;
  std::vector<std::uint32_t> next_, last_;
  CornerGrid reflex_;
};

/// The corners that may be ears, in the order in which they are tried: each stands in the queue once, at the
/// last place it was put.
class Candidates {
 public:
  explicit Candidates(std::uint32_t size) : tickets_(size) {}

  void put(std::uint32_t corner) { queue_.push_back({corner, ++tickets_[corner]}); }

  /// The next one, or nothing.
  std::optional<std::uint32_t> take() {
    while (!queue_.empty()) {
      const auto [corner, ticket] = queue_.front();
      queue_.pop_front();
      if (ticket == tickets_[corner]) return corner;
    }
    return std::nullopt;
  }

 private:
  std::deque<std::pair<std::uint32_t, std::uint32_t>> queue_;
  std::vector<std::uint32_t> tickets_;  ///< the last of each
};

/// Cuts a ring down to a triangle. Only the neighbours of an ear that was cut are tried again, and, a few
/// times, all that are left: so the work is linear in the corners, but for those that lie in others' way.
class Cutter {
 public:
  Cutter(std::vector<Point2> points, std::vector<Index3>& triangles)
      : ring_(std::move(points)), candidates_(ring_.size()), triangles_(triangles), left_(ring_.size()) {}

  void run() {
    constexpr int most_rounds = 16;
    std::uint32_t before = left_ + 1;
    for (int round = 0; round < most_rounds && left_ > 3 && left_ < before; ++round) {
      before = left_;
      put_all();
      while (left_ > 3) {
        const std::optional<std::uint32_t> corner = candidates_.take();
        if (!corner) break;
        if (!ring_.is_cut(*corner) && ring_.is_ear(*corner)) cut(*corner);
      }
    }
    // What no ear is left of is not simple: cut anywhere.
    while (left_ > 3) cut(at_);
    triangles_.push_back({ring_.next(at_), ring_.last(at_), at_});
  }

 private:
  /// From the corner at hand on; of a convex quad first 1: (0,1,2) and (0,2,3).
  void put_all() {
    std::uint32_t corner = at_;
    for (std::uint32_t i = 0; i < left_; ++i, corner = ring_.next(corner)) candidates_.put(corner);
  }

  void cut(std::uint32_t corner) {
    const std::uint32_t before = ring_.last(corner), after = ring_.next(corner);
    triangles_.push_back({before, corner, after});
    ring_.cut(corner);
    --left_;
    candidates_.put(after);  // behind all others: fans have thinner triangles
    candidates_.put(before);
    at_ = ring_.next(after);
  }

  Ring ring_;
  Candidates candidates_;
  std::vector<Index3>& triangles_;
  std::uint32_t left_;
  std::uint32_t at_ = 1;
};

}  // namespace

void triangulate(const std::vector<Vec3d>& corners, std::vector<Index3>& triangles) {
  const std::vector<Vec3d> scaled = normalized(corners);
  if (scaled.empty()) {
    for (std::uint32_t i = 2; i < corners.size(); ++i) triangles.push_back({0, i - 1, i});
    return;
  }
  Cutter(project(scaled), triangles).run();
}

}  // namespace castray
