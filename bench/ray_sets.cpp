#include "ray_sets.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace castray {
namespace {

class RayMaker {
 public:
  RayMaker(const MeshView& mesh, const WideBvhView& bvh, const KernelApi& kernel,
           const RaySetOptions& options)
      : mesh_(mesh), bvh_(bvh), kernel_(kernel), options_(options), camera_(camera()) {
    const Vec3d lower(bvh.lower[0], bvh.lower[1], bvh.lower[2]),
        upper(bvh.upper[0], bvh.upper[1], bvh.upper[2]);
    size_ = length(upper - lower);
    corner_ = {lower.x, upper.y + 0.5 * size_, lower.z};
    edge1_ = {upper.x - lower.x, 0, 0};
    edge2_ = {0, 0, upper.z - lower.z};
    if (const auto& q = options.quad; !q.empty()) {
      corner_ = {q[0], q[1], q[2]};
      edge1_ = {q[3], q[4], q[5]};
      edge2_ = {q[6], q[7], q[8]};
    }
  }

  void add_primary(int x, int y) {
    add(camera_.position, camera_.direction(x + 0.5, y + 0.5, options_.resolution, options_.resolution),
        std::numeric_limits<float>::infinity());
  }

  void add_secondary(int x, int y, bool shadow) {
    const Vec3d direction = camera_.direction(x + 0.5, y + 0.5, options_.resolution, options_.resolution);
    const Vec3f o(camera_.position), d(direction);
    constexpr float infinity = std::numeric_limits<float>::infinity();
    float t, b1, b2;
    std::uint32_t triangle;
    kernel_.bvh_closest(bvh_, {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z, &infinity, &t, &triangle, &b1, &b2, 1});
    if (triangle == no_hit) return;
    const Index3& v = mesh_.triangles[triangle];
    const Vec3d p0(mesh_.positions[v[0]]), p1(mesh_.positions[v[1]]), p2(mesh_.positions[v[2]]);
    Vec3d normal = cross(p1 - p0, p2 - p0);
    if (!(length(normal) > 0)) return;
    normal = normalize(normal) * (dot(normal, direction) > 0 ? -1.0 : 1.0);
    const Vec3d p = p0 + (p1 - p0) * double(b1) + (p2 - p0) * double(b2) + normal * (1e-5 * size_);
    const double u1 = number_(random_), u2 = number_(random_);
    if (shadow) return add(p, corner_ + edge1_ * u1 + edge2_ * u2 - p, 0.9999f);
    const double phi = 2 * std::numbers::pi * u1, r = std::sqrt(u2);
    const Vec3d tangent =
        normalize(cross(std::abs(normal.x) > 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0), normal));
    const Vec3d local = tangent * (r * std::cos(phi)) + cross(normal, tangent) * (r * std::sin(phi));
    add(p, local + normal * std::sqrt(1 - u2), infinity);
  }

  std::vector<float> rays;

 private:
  Camera camera() const {
    const auto& c = options_.camera;
    const Vec3d position(c[0], c[1], c[2]), look_at(c[3], c[4], c[5]), forward = look_at - position;
    const bool vertical = std::abs(forward.y) > 0.999 * length(forward);
    return make_camera(position, look_at, vertical ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0), options_.fov);
  }

  void add(const Vec3d& o, const Vec3d& d, float t_max) {
    for (const double n : {o.x, o.y, o.z, d.x, d.y, d.z}) rays.push_back(static_cast<float>(n));
    rays.push_back(t_max);
  }

  MeshView mesh_;
  WideBvhView bvh_;
  const KernelApi& kernel_;
  RaySetOptions options_;
  Camera camera_;
  double size_;
  Vec3d corner_, edge1_, edge2_;
  std::mt19937 random_{1};
  std::uniform_real_distribution<double> number_{0, 1};
};

}  // namespace

std::vector<float> make_rays(const std::string& kind, const MeshView& mesh, const WideBvhView& bvh,
                             const KernelApi& kernel, const RaySetOptions& options) {
  RayMaker maker(mesh, bvh, kernel, options);
  const int size = options.resolution;
  for (int top = 0; top < size; top += 8) {
    for (int left = 0; left < size; left += 8) {
      for (int y = top; y < std::min(top + 8, size); ++y) {
        for (int x = left; x < std::min(left + 8, size); ++x) {
          if (kind == "primary") {
            maker.add_primary(x, y);
          } else {
            maker.add_secondary(x, y, kind == "shadow");
          }
        }
      }
    }
  }
  return maker.rays;
}

}  // namespace castray
