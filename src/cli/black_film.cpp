#include "cli/black_film.h"

#include <algorithm>
#include <vector>

#include "core/threads.h"
#include "core/triangle_corners.h"
#include "geometry/bvh.h"
#include "geometry/list.h"

namespace castray::cli {

namespace {

/// What a few rays from the camera meet.
struct Counts {
  int hits = 0;
  int backs = 0;       ///< hits on the side that is not outward
  int dark_sides = 0;  ///< of lights, that are hit
  int facing = 0;      ///< hits in front of the shining side of some light
  int reached = 0;     ///< hits that see such a light
};

Counts count(const Scene& scene) {
  const Bvh bvh = Bvh::build(mesh_of(scene), available_threads());
  constexpr int side = 24;
  constexpr std::size_t most_lights = 16;
  const std::size_t step = std::max<std::size_t>(1, scene.lights.size() / most_lights);
  Counts counts;
  for (int i = 0; i < side * side; ++i) {
    const double x = (i % side + 0.5) * scene.width / side, y = (i / side + 0.5) * scene.height / side;
    const CameraRay ray = scene.camera.ray(x, y, scene.width, scene.height, 0, 0);
    const Vec3d direction = normalize(ray.direction);
    const Hit<double> hit = bvh.closest(Ray<double>{ray.origin, direction});
    if (!hit.found()) continue;
    const Vec3d normal = corners_of(scene, hit.triangle).twice_area();
    const double towards_camera = dot(normal, direction) > 0 ? -1 : 1;
    const Vec3d p = ray.origin + direction * (hit.t * (1 - 1e-6));
    bool facing = false, reached = false;
    for (std::size_t l = 0; l < scene.lights.size(); l += step) {
      const TriangleCorners light = corners_of(scene, scene.lights[l]);
      const Vec3d to_light = light.middle() - p;
      const bool shines_here =
          scene.emits_on(scene.triangle_material[scene.lights[l]], dot(light.twice_area(), to_light) < 0);
      if (!shines_here || !(dot(normal, to_light) * towards_camera > 0)) continue;
      facing = true;
      reached |= !bvh.occluded(Ray<double>{p, to_light, 1 - 1e-6});
    }
    ++counts.hits;
    counts.backs += towards_camera < 0;
    const std::uint16_t material = scene.triangle_material[hit.triangle];
    counts.dark_sides += scene.emits(material) && !scene.emits_on(material, towards_camera > 0);
    counts.facing += facing;
    counts.reached += reached;
  }
  return counts;
}

}  // namespace

bool is_black(const Film& film) {
  const Window& w = film.window();
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x)
      if (film.mean(x, y) != Vec3d{}) return false;
  return true;
}

std::string why_black(const Scene& scene, const RenderOptions& options) {
  const Counts counts = count(scene);
  if (counts.hits == 0)
    return "the camera sees nothing of the scene; look elsewhere with --look-from, --look-at";
  if (options.max_depth == 1) return "--max-depth 1 shows what emits only, and none of it is seen";
  if (counts.reached == 0 && counts.backs == counts.hits && counts.dark_sides == 0)
    return "the camera is inside a closed surface that no light enters; move it with --look-from";
  if (!scene.lights.empty() && counts.facing == 0)
    return "its lights face away from all that is seen: they shine on the side from which their corners run "
           "counter-clockwise; --two-sided-lights lets them shine on both";
  if (counts.reached == 0) return "everything that is seen lies in shadow";
  return "what is seen reflects nothing";
}

}  // namespace castray::cli
