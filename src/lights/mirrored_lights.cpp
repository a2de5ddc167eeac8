#include "lights/mirrored_lights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/box.h"
#include "core/put.h"
#include "core/triangle_corners.h"
#include "materials/descriptor.h"

namespace castray {

namespace {

/// The largest and the strongest are looked at; no scene needs more of them to find its great mirrors.
constexpr std::size_t most_triangles = 1024, most_mirrors = 64, most_lights = 64;

/// The numbers below `count` whose `value` is greatest and above 0, `most` of them at most, in that order.
template <class Value>
std::vector<std::uint32_t> greatest(std::size_t count, std::size_t most, Value value) {
  std::vector<std::pair<double, std::uint32_t>> found;
  for (std::uint32_t i = 0; i < count; ++i)
    if (const double v = value(i); v > 0) found.emplace_back(-v, i);
  const auto end = found.begin() + static_cast<std::ptrdiff_t>(std::min(most, found.size()));
  std::partial_sort(found.begin(), end, found.end());
  std::vector<std::uint32_t> numbers;
  for (auto i = found.begin(); i != end; ++i) numbers.push_back(i->second);
  return numbers;
}

/// A flat mirror: coplanar triangles of one material.
struct Mirror {
  Vec3d normal;
  double offset;
  std::uint16_t material;
  double area = 0;
  Box3d bounds{};

  bool holds(const Vec3d& p, double tolerance) const { return std::abs(dot(normal, p) - offset) < tolerance; }
};

bool reflects(const Material& m) {
  const std::uint32_t traits = traits_of(m);
  return (traits & (trait_specular | trait_focuses)) && !(traits & trait_transmits);
}

std::vector<std::uint32_t> reflecting_triangles(const Scene& scene) {
  std::vector<bool> is_mirror;
  for (const Material& m : scene.materials) is_mirror.push_back(reflects(m));
  return greatest(scene.triangles.size(), most_triangles, [&](std::uint32_t i) {
    return is_mirror[scene.triangle_material[i]] ? length(corners_of(scene, i).twice_area()) : 0;
  });
}

void grow(Mirror& mirror, const TriangleCorners& triangle) {
  mirror.area += length(triangle.twice_area()) / 2;
  for (const Vec3d& p : triangle.all()) mirror.bounds.add(p);
}

std::vector<Mirror> flat_mirrors(const Scene& scene) {
  constexpr double flat = 1e-4;  // of a triangle's size
  std::vector<Mirror> mirrors;
  for (const std::uint32_t i : reflecting_triangles(scene)) {
    const TriangleCorners triangle = corners_of(scene, i);
    const double twice_area = length(triangle.twice_area());
    const std::uint16_t material = scene.triangle_material[i];
    const auto same = std::ranges::find_if(mirrors, [&](const Mirror& m) {
      return m.material == material && std::ranges::all_of(triangle.all(), [&](const Vec3d& p) {
               return m.holds(p, flat * std::sqrt(twice_area / 2));
             });
    });
    if (same != mirrors.end()) {
      grow(*same, triangle);
    } else if (mirrors.size() < most_mirrors) {
      const Vec3d normal = triangle.twice_area() / twice_area;
      mirrors.push_back({normal, dot(normal, triangle.a), material});
      grow(mirrors.back(), triangle);
    }
  }
  return mirrors;
}

Vec3d vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

/// The vector that has a dot product of 1 with `edge`, and of 0 with `other` and `normal`.
Vec3d across(const Vec3d& edge, const Vec3d& other, const Vec3d& normal) {
  const Vec3d v = cross(other, normal);
  return v / dot(v, edge);
}

Vec3d center_of(const KernelLight& light) {
  return vec(light.origin) + (vec(light.edge1) + vec(light.edge2)) * 0.5;
}

double power_of(const KernelLight& light) { return double{light.area} * luminance(vec(light.emission)); }

bool is_in_front(const Mirror& mirror, const KernelLight& light) {
  return dot(mirror.normal, center_of(light)) > mirror.offset;
}

/// How far the edge of the image of a point this far in front of a mirror of width alpha is blurred.
double blur(double alpha, double height) { return 2 * alpha * height; }

MirroredLight image_in(const Mirror& mirror, const KernelLight& light, double alpha) {
  Vec3d edge1 = vec(light.edge1), edge2 = vec(light.edge2), center = center_of(light);
  const double height = dot(mirror.normal, center) - mirror.offset;
  const auto reflected = [&](const Vec3d& v) { return v - mirror.normal * (2 * dot(mirror.normal, v)); };
  center = center - mirror.normal * (2 * height);
  const double wider = 2 * blur(alpha, 2 * height);
  edge1 = reflected(edge1) * (1 + wider / length(edge1));
  edge2 = reflected(edge2) * (1 + wider / length(edge2));
  const Vec3d normal = reflected(vec(light.normal));
  MirroredLight image{};
  put(image.origin, center - (edge1 + edge2) * 0.5);
  put(image.edge1, edge1);
  put(image.edge2, edge2);
  put(image.across1, across(edge1, edge2, normal));
  put(image.across2, across(edge2, edge1, normal));
  put(image.normal, normal);
  put(image.center, center);
  image.radius = static_cast<float>((length(edge1) + length(edge2)) / 2);
  image.area = static_cast<float>(length(cross(edge1, edge2)));
  put(image.plane, mirror.normal);
  image.offset = static_cast<float>(mirror.offset);
  put(image.mirror_center, (mirror.bounds.lower + mirror.bounds.upper) * 0.5);
  put(image.mirror_half, (mirror.bounds.upper - mirror.bounds.lower) * 0.5);
  image.two_sided = light.two_sided;
  return image;
}

}  // namespace

std::vector<MirroredLight> mirrored_lights(const Scene& scene, const std::vector<KernelLight>& lights) {
  constexpr double least_mirror = 0.5;  // of the light's area
  const std::vector<std::uint32_t> strongest =
      greatest(lights.size(), most_lights, [&](std::uint32_t i) { return power_of(lights[i]); });
  std::vector<MirroredLight> images;
  std::vector<double> promises;
  for (const Mirror& mirror : flat_mirrors(scene))
    for (const std::uint32_t i : strongest) {
      const KernelLight& light = lights[i];
      if (!is_in_front(mirror, light) || mirror.area < least_mirror * double{light.area}) continue;
      images.push_back(image_in(mirror, light, scene.materials[mirror.material].alpha));
      images.back().power = static_cast<float>(power_of(light) / power_of(lights[strongest.front()]));
      promises.push_back(double{images.back().power} * mirror.area);
    }
  std::vector<MirroredLight> best;
  for (const std::uint32_t i :
       greatest(images.size(), most_mirrored_lights, [&](std::uint32_t k) { return promises[k]; }))
    best.push_back(images[i]);
  return best;
}

}  // namespace castray
