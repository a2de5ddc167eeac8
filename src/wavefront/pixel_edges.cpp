#include "wavefront/pixel_edges.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

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

/// The corners along the upper sides of a row of pixels.
class Corners {
 public:
  /// Columns x0 <= x < x0 + count.
  Corners(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data, const Window& window,
          int x0, std::size_t count, int y)
      : scene_(&scene), data_(&data), rays_(count), hits_(count), found_(count) {
    for (std::size_t i = 0; i < count; ++i) {
      const CameraRay ray =
          scene.camera.ray(x0 + static_cast<int>(i), y, window.full_width, window.full_height, 0, 0);
      rays_.set(i, {Vec3f(ray.origin), Vec3f(normalize(ray.direction))});
    }
    rays_.closest([&](const RayBatch& b) { closest_hits(kernel, data, true, b); }, 0, count, hits_.data());
  }

  /// Whether its corner i and corner k of another row see different surfaces. Nearly all see one triangle,
  /// or nothing.
  bool differs(std::size_t i, Corners& other, std::size_t k) {
    const Hit<float>&a = hits_[i], &b = other.hits_[k];
    if (a.triangle == b.triangle && a.instance == b.instance) return false;
    return differ(at(i), other.at(k));
  }

  /// Whether the camera sees a lamp at corner i. The sky does not count: it is seldom much brighter than what
  /// stands before it, and then a ray that says which of both is seen had better say what it brings as well.
  bool sees_lamp(std::size_t i) {
    const std::uint32_t material = at(i).material;
    return material != nothing && scene_->emits(static_cast<std::uint16_t>(material));
  }

 private:
  const Corner& at(std::size_t i) {
    std::optional<Corner>& corner = found_[i];
    if (corner) return *corner;
    if (!hits_[i].found()) return corner.emplace();
    const auto [normal, material] = surface_hit(*scene_, *data_, hits_[i]);
    return corner.emplace(Corner{material, rays_[i].origin + rays_[i].direction * hits_[i].t, normal});
  }

  const Scene* scene_;
  const KernelSceneData* data_;
  RayArrays rays_;
  std::vector<Hit<float>> hits_;
  std::vector<std::optional<Corner>> found_;
};

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
      return Corners(scene, kernel, data, window, x0_, static_cast<std::size_t>(width_) + 1, y0_ + row);
    };
    Corners above = corners_of(begin);
    for (int row = begin; row < std::min(begin + rows_of_a_strip, height); ++row) {
      Corners below = corners_of(row + 1);
      std::uint8_t* kinds = &kinds_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_)];
      for (std::size_t x = 0; x < static_cast<std::size_t>(width_); ++x) {
        // around the pixel; which of two corners comes first matters to nearly flat steps
        if (!above.differs(x, above, x + 1) && !above.differs(x + 1, below, x + 1) &&
            !below.differs(x + 1, below, x) && !below.differs(x, above, x))
          continue;
        const bool lamp =
            above.sees_lamp(x) || above.sees_lamp(x + 1) || below.sees_lamp(x) || below.sees_lamp(x + 1);
        kinds[x] = lamp ? lamp_edge : edge;
      }
      above = std::move(below);
    }
  }
}

}  // namespace castray
