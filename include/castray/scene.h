#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "castray/camera.h"
#include "castray/error.h"
#include "castray/material.h"
#include "castray/vec.h"

namespace castray {

/// A rendering flag of a scene file's "render" section.
struct RenderDefault {
  std::string name;   ///< without dashes
  std::string value;  ///< as on the command line: true and false are "on" and "off", arrays joined by commas
  SourcePlace place;  ///< of the key
};

/// Something in a scene's files that is missing or odd, and what was done instead of refusing them.
struct SceneWarning {
  SourcePlace place;  ///< where it is found first
  std::string message;
  bool harmless = false;    ///< the picture is what the files mean
  std::uint64_t count = 1;  ///< of places

  /// "FILE:LINE: message (N times)".
  std::string text() const;
};

inline constexpr int max_image_side = 65536;
inline constexpr int max_image_pixels = 1 << 28;

using Index3 = std::array<std::uint32_t, 3>;

/// An image of the environment in latitude and longitude: its top row is at +y, its middle column at +z, and
/// the column a quarter from the left at +x. Each texel is a patch of one radiance.
struct EnvironmentImage {
  int texture = -1;     ///< index into Scene::textures, or -1: none, the environment is constant
  double scale = 1;     ///< factor of its values, >= 0
  double rotation = 0;  ///< degrees about +y, counter-clockwise as seen from above

  bool used() const { return texture >= 0; }
};

/// A light without size, which no ray meets: it is seen by what it lights. From a point or a spot light
/// arrives intensity / distance^2, from a directional one, which is infinitely far away, `intensity`: on a
/// surface that faces it.
struct DeltaLight {
  enum class Kind : std::uint8_t { point, spot, directional };
  Kind kind = Kind::point;
  Vec3d position;             ///< in scene space; of point and spot lights
  Vec3d direction{0, 0, -1};  ///< unit, in which light travels; of a spot light: its axis
  Vec3d intensity;            ///< linear RGB; of point and spot lights over the square of Scene::unit
  /// Of a spot light: cosines of the half angles beyond which nothing shines, and within which all does.
  /// Between them, ((cos - cos_outer) / (cos_inner - cos_outer))^2 does.
  double cos_outer = 0, cos_inner = 1;
};

/// Triangles of one name: from `first_triangle` on, to the next object's.
struct SceneObject {
  std::string name;
  std::uint32_t first_triangle = 0;
};

/// A mesh that instances show: triangles first .. first + count - 1 of the scene's. Their positions are in a
/// space of the mesh's own, every coordinate in [-1,1].
struct SharedMesh {
  std::uint32_t first = 0, count = 0;
};

/// A shared mesh at its place: p of its space is at rows . p + translation in scene space. A mirroring one
/// keeps the outward side of its triangles outward.
struct SceneInstance {
  std::uint32_t mesh = 0;  ///< into Scene::shared_meshes
  Vec3f rows[3];
  Vec3f translation;

  Vec3d linear(const Vec3d& v) const {
    return {dot(Vec3d(rows[0]), v), dot(Vec3d(rows[1]), v), dot(Vec3d(rows[2]), v)};
  }
  Vec3d point(const Vec3d& p) const { return linear(p) + Vec3d(translation); }
  bool mirrors() const { return dot(Vec3d(rows[0]), cross(Vec3d(rows[1]), Vec3d(rows[2]))) < 0; }
};

/// One of the cameras that a scene's files have.
struct SceneCamera {
  std::string name;
  Camera camera;              ///< in scene space
  int width = 0, height = 0;  ///< the image size that goes with it; 0: the scene's
};

/// A scene, an immutable value once loaded.
///
/// Geometry lives in *scene space*: the input is parsed in double, moved so that the middle of its bounds is
/// the origin, and divided by a power of two so that every coordinate is in [-1,1]; only then is it rounded
/// to float. world = center + unit * scene. Radiance does not depend on this map.
struct Scene {
  std::string name;            ///< file name without its suffix
  std::filesystem::path file;  ///< as the user gave it

  Camera camera;                     ///< in scene space
  bool has_camera = false;           ///< its files say which; else it is `automatic_camera`
  int width = 784, height = 784;     ///< image size in pixels
  std::vector<SceneCamera> cameras;  ///< all that its files have, `camera` the first; by names of their own

  Vec3d center{0, 0, 0};
  double unit = 1;  ///< a power of two

  std::vector<Vec3f> positions;  ///< in scene space
  std::vector<Index3>
      triangles;  ///< into positions; counter-clockwise seen from the side the normal points to
  std::vector<std::uint16_t> triangle_material;  ///< per triangle, into materials
  std::vector<SceneObject> objects;              ///< by ascending first triangle, the first of them 0
  std::vector<Vec3f> normals;                    ///< unit shading normals, or empty
  std::vector<Index3>
      triangle_normals;  ///< per triangle into normals, `no_index` where it has none; or empty
  std::vector<std::array<float, 2>> uvs;
  std::vector<Index3> triangle_uvs;     ///< per triangle into uvs, `no_index` where it has none; or empty
  std::vector<Vec3f> colors;            ///< linear RGB in [0,1], of vertices
  std::vector<Index3> triangle_colors;  ///< per triangle into colors, `no_index` where it has none; or empty

  /// The triangles in front of theirs are in scene space: all lights are among them.
  std::vector<SharedMesh> shared_meshes;
  std::vector<SceneInstance> instances;

  std::vector<Material> materials;
  std::vector<Texture> textures;
  Vec3d environment{0, 0, 0};  ///< radiance from every direction that hits nothing; an image's mean over them
  EnvironmentImage environment_image;
  std::vector<std::uint32_t> lights;  ///< the triangles that emit on some side, ascending
  std::vector<DeltaLight> delta_lights;

  std::vector<RenderDefault> render_defaults;  ///< in the file's order

  // What happened while loading, for `info` and for messages.
  std::uint64_t dropped_triangles = 0;    ///< degenerate: zero area, NaN, infinite
  std::uint64_t expanded_instances = 0;   ///< that became meshes of their own
  std::vector<std::string> ignored_keys;  ///< "FILE: key", of MTL files
  std::vector<SceneWarning> warnings;     ///< in the order in which they were met
  bool default_environment = false;       ///< the environment is no file's: nothing in the scene emits more

  static constexpr std::uint32_t no_index = 0xffffffffu;

  const Material& material_of(std::uint32_t triangle) const { return materials[triangle_material[triangle]]; }
  /// What a material is on one of its sides: on the front, where the normal points to, itself.
  std::uint16_t on_side(std::uint16_t material, bool front) const {
    const Material& m = materials[material];
    return front || !m.has_back() ? material : static_cast<std::uint16_t>(m.back);
  }
  /// Whether a triangle of this material emits on that side.
  bool emits_on(std::uint16_t material, bool front) const {
    return materials[on_side(material, front)].emits_on(front);
  }
  /// Whether a triangle of this material emits on some side.
  bool emits(std::uint16_t material) const { return emits_on(material, true) || emits_on(material, false); }
  /// What emits of this material: itself, and what it is on its back, each a light of its own.
  std::vector<std::uint16_t> emitting_sides(std::uint16_t material) const;
  /// By material, whether some triangle has it on one of its sides.
  std::vector<bool> used_materials() const;
  /// The triangle's object, into objects.
  std::size_t object_of(std::uint32_t triangle) const;
  /// How many triangles are in scene space, not in a shared mesh's.
  std::uint32_t own_triangles() const {
    return shared_meshes.empty() ? static_cast<std::uint32_t>(triangles.size()) : shared_meshes.front().first;
  }
  /// How many triangles are shown: those in scene space, and each instance's.
  std::uint64_t shown_triangles() const;
  /// A box around everything, in scene space: its lower and its upper corner. Around instances it may be
  /// loose.
  std::array<Vec3d, 2> bounds() const;

  Vec3d to_world(const Vec3d& p) const { return center + p * unit; }
  Vec3d to_scene(const Vec3d& p) const { return (p - center) / unit; }
  Camera to_world(const Camera& camera) const;
  Camera to_scene(const Camera& camera) const;
  DeltaLight to_world(const DeltaLight& light) const;
  DeltaLight to_scene(const DeltaLight& light) const;
};

/// A view, in scene space, that frames all of `scene` in its image size. It looks from the front right above
/// (+z, +x, +y), unless from there it would see much less of what faces a light, or of the surfaces' outward
/// sides, than from another of nine directions: a room is looked into from its open side.
Camera automatic_camera(const Scene& scene);

/// Reads a scene .json, a .gltf or .glb, an .obj or a .ply (seen by an automatic view, where there is no
/// camera); "-" is one of them on the standard input, a .gltf apart.
/// Throws InputError with the place of the first error.
///
/// A mirroring transform (negative determinant) keeps each mesh's outward side outward: the counter-clockwise
/// order of its triangles is turned round with it, so what emitted outwards still does.
Scene load_scene(const std::filesystem::path& file);

/// Puts an image in latitude and longitude in place of the scene's environment. Throws InputError.
void replace_environment(const std::filesystem::path& image, Scene& scene);

}  // namespace castray
