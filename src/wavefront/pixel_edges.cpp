#include "wavefront/pixel_edges.h"

#include <algorithm>

#include "geometry/ray_arrays.h"
#include "wavefront/host_rays.h"

namespace castray {

namespace {

constexpr int rows_of_a_strip = 16;
/// As far as the pixels of tiles that have pixels in a window lie outside it.
constexpr int margin = tile_size - 1 + 2 * ragged_reach;
/// Two points are of one surface if the cosine between their normals and the sine between the line through
/// them and the surface are within these.
constexpr float least_cosine = 0.9f, most_sine = 0.2f;
constexpr std::uint32_t nothing = ~0u;

/// What the camera sees at a pixel's corner.
struct Corner {
  std::uint32_t material = nothing;
  Vec3f p, normal;
};

bool differ(const Corner& a, const Corner& b) {
  if (a.material != b.material) return true;
  if (a.material == nothing) return false;
  const Vec3f apart = b.p - a.p;
  return std::abs(dot(a.normal, b.normal)) < least_cosine ||
         std::abs(dot(a.normal, apart)) > most_sine * length(apart);
}

/// Whether neighbours of a pixel's corners, in their order around it, differ.
bool is_edge(const Corner (&corners)[4]) {
  for (int i = 0; i < 4; ++i)
    if (differ(corners[i], corners[(i + 1) % 4])) return true;
  return false;
}

/// Whether the camera sees a lamp at one of them. The sky does not count: it is seldom much brighter than
/// what stands before it, and then a ray that says which of both is seen had better say what it brings as
/// well.
bool sees_lamp(const Scene& scene, const Corner (&corners)[4]) {
  return std::ranges::any_of(corners, [&](const Corner& corner) {
    return corner.material != nothing && scene.emits(static_cast<std::uint16_t>(corner.material));
  });
}

/// The corners along the upper sides of a row of pixels.
std::vector<Corner> corners(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data,
                            const Window& window, int x0, int x1, int y) {
  RayArrays rays;
  for (int x = x0; x <= x1; ++x) {
    const CameraRay ray = scene.camera.ray(x, y, window.full_width, window.full_height, 0, 0);
    rays.add({Vec3f(ray.origin), Vec3f(normalize(ray.direction))});
  }
  std::vector<Hit<float>> hits(rays.size());
  rays.closest([&](const RayBatch& b) { closest_hits(kernel, data, true, b); }, 0, rays.size(), hits.data());
  std::vector<Corner> found(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i].found()) continue;
    const auto [normal, material] = surface_hit(scene, data, hits[i]);
    found[i] = {material, rays[i].origin + rays[i].direction * hits[i].t, normal};
  }
  return found;
}

}  // namespace

bool PixelEdges::any(int x0, int y0, int x1, int y1) const {
  for (int y = y0; y < y1; ++y) {
    const std::uint8_t* kinds = &kinds_[place(x0, y)];
    if (std::any_of(kinds, kinds + (x1 - x0), [](std::uint8_t kind) { return kind != smooth; })) return true;
  }
  return false;
}

PixelEdges::PixelEdges(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data,
                       const Window& window, int threads)
    : x0_(window.x0 - margin), y0_(window.y0 - margin), width_(window.width() + 2 * margin) {
  const int height = window.height() + 2 * margin;
  kinds_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height));
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (int begin = 0; begin < height; begin += rows_of_a_strip) {
    const auto corners_of = [&](int row) {
      return corners(scene, kernel, data, window, x0_, x0_ + width_, y0_ + row);
    };
    std::vector<Corner> above = corners_of(begin);
    for (int row = begin; row < std::min(begin + rows_of_a_strip, height); ++row) {
      std::vector<Corner> below = corners_of(row + 1);
      std::uint8_t* kinds = &kinds_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_)];
      for (std::size_t x = 0; x + 1 < above.size(); ++x) {
        const Corner seen[] = {above[x], above[x + 1], below[x + 1], below[x]};
        if (is_edge(seen)) kinds[x] = sees_lamp(scene, seen) ? lamp_edge : edge;
      }
      above = std::move(below);
    }
  }
}

}  // namespace castray
