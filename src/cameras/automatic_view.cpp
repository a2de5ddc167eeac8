#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "castray/scene.h"
#include "core/box.h"
#include "core/triangle_corners.h"

namespace castray {

namespace {

constexpr double fov = 40;

/// A point of a surface, or of a light: where, and the side that is outward.
struct SurfacePoint {
  Vec3d position, normal;
};

/// About `count` points of the triangles first .. last as `triangle_of` numbers them, evenly by area: each
/// triangle has one each time the area so far passes another multiple of a count-th of all.
template <class TriangleOf>
std::vector<SurfacePoint> sample_surface(const Scene& scene, std::size_t triangles, int count,
                                         const TriangleOf& triangle_of) {
  double area = 0;
  for (std::size_t i = 0; i < triangles; ++i)
    area += length(corners_of(scene, triangle_of(i)).twice_area() * 0.5);
  const double step = area / count;
  std::vector<SurfacePoint> points;
  if (!(step > 0)) return points;
  double passed = 0, next = step / 2;
  for (std::size_t i = 0; i < triangles; ++i) {
    const TriangleCorners corners = corners_of(scene, triangle_of(i));
    const auto& [a, b, c] = corners;
    const Vec3d vector = corners.twice_area() * 0.5;
    const double size = length(vector);
    passed += size;
    for (; next < passed; next += step) {
      // A sequence of low discrepancy (Roberts 2018) on the unit square, folded onto the triangle.
      const auto number = static_cast<double>(points.size());
      double u = std::fmod(number * 0.7548776662466927, 1), v = std::fmod(number * 0.5698402909980532, 1);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points.push_back({a + (b - a) * u + (c - a) * v, vector / size});
    }
  }
  return points;
}

/// A view along `forward` that shows all positions, as near as its margin allows.
Camera frame(const Scene& scene, const Vec3d& forward, const Vec3d& up, const std::vector<Vec3d>& corners) {
  Camera camera = make_camera({}, forward, up, fov);
  constexpr double margin = 1.05;
  const double half_height = camera.tan_half_fov / margin;
  const double half_width = half_height * scene.width / scene.height;
  double distance = 0;
  for (const Vec3d& p : corners)
    distance = std::max({distance, std::abs(dot(p, camera.right)) / half_width - dot(p, camera.forward),
                         std::abs(dot(p, camera.up)) / half_height - dot(p, camera.forward)});
  camera.position = camera.forward * -distance;
  return camera;
}

/// What a coarse image of the scene's points shows.
struct Sight {
  int seen = 0;   ///< cells of the image that show a surface
  int front = 0;  ///< of them, those that show its outward side
  int lit = 0;    ///< and those that face a light, or shine

  /// In [0,1]: the share of what is seen that is outward; where there are lights, facing one counts twice as
  /// much.
  double merit(bool lights) const {
    if (seen == 0) return 0;
    return lights ? (front + 2.0 * lit) / (3.0 * seen) : static_cast<double>(front) / seen;
  }
};

Sight look(const Camera& camera, const Scene& scene, const std::vector<SurfacePoint>& points,
           const std::vector<SurfacePoint>& lights) {
  constexpr int side = 32;
  struct Cell {
    double depth = std::numeric_limits<double>::infinity();
    const SurfacePoint* point = nullptr;
  };
  std::vector<Cell> cells(side * side);
  const double aspect = static_cast<double>(scene.width) / scene.height;
  for (const SurfacePoint& point : points) {
    const Vec3d d = point.position - camera.position;
    const double depth = dot(d, camera.forward);
    if (!(depth > 0)) continue;
    const double reach = depth * camera.tan_half_fov;
    const auto cell = [](double x) { return std::clamp(static_cast<int>((x + 1) * side / 2), 0, side - 1); };
    Cell& nearest = cells[static_cast<std::size_t>(cell(dot(d, camera.up) / reach) * side +
                                                   cell(dot(d, camera.right) / (reach * aspect)))];
    if (depth < nearest.depth) nearest = {depth, &point};
  }
  Sight sight;
  for (const Cell& cell : cells) {
    if (!cell.point) continue;
    const SurfacePoint& p = *cell.point;
    const bool front = dot(p.normal, camera.position - p.position) > 0;
    const Vec3d seen_side = front ? p.normal : -p.normal;
    const bool lit = std::ranges::any_of(lights, [&](const SurfacePoint& light) {
      const Vec3d to_light = light.position - p.position;
      return dot(seen_side, to_light) > 0 && dot(light.normal, to_light) < 0;
    });
    ++sight.seen;
    sight.front += front;
    sight.lit += lit;
  }
  return sight;
}

}  // namespace

Camera automatic_camera(const Scene& scene) {
  constexpr int surface_points = 1 << 16, light_points = 16;
  const auto points = sample_surface(scene, scene.own_triangles(), surface_points,
                                     [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  const auto lights = sample_surface(scene, scene.lights.size(), light_points,
                                     [&](std::size_t i) { return scene.lights[i]; });
  const auto [low, high] = scene.bounds();
  const Vec3d middle = (low + high) * 0.5;
  std::vector<Vec3d> corners;
  for (const Vec3d& corner : Box3d{low, high}.corners()) corners.push_back(corner - middle);

  // From where to look, the usual view first; a later one must show clearly more. Leaves and thin parts show
  // either side about as often: they are no reason to look straight down or up, as at a room without its
  // ceiling.
  constexpr double clearly = 1.5, enough = 0.4;
  const Vec3d viewpoints[] = {{0.5, 0.4, 1}, {1, 0.4, -0.5}, {-0.5, 0.4, -1}, {-1, 0.4, 0.5}, {0, 0, 1},
                              {1, 0, 0},     {0, 0, -1},     {-1, 0, 0},      {0, 1, 0},      {0, -1, 0}};
  Camera best;
  double best_merit = 0, usual_merit = 0;
  int usual_seen = 0;
  for (const Vec3d& towards_viewer : viewpoints) {
    const bool vertical = towards_viewer.x == 0 && towards_viewer.z == 0;
    if (vertical && usual_merit >= enough) break;
    Camera camera =
        frame(scene, -towards_viewer, vertical ? Vec3d{0, 0, -towards_viewer.y} : Vec3d{0, 1, 0}, corners);
    camera.position = camera.position + middle;
    const Sight sight = look(camera, scene, points, lights);
    const double merit = sight.merit(!lights.empty());
    if (&towards_viewer == viewpoints) {
      best = camera;
      best_merit = usual_merit = merit;
      usual_seen = sight.seen;
    } else if (sight.seen > usual_seen / 3 && merit > clearly * best_merit) {
      best = camera;
      best_merit = merit;
    }
  }
  return best;
}

}  // namespace castray
