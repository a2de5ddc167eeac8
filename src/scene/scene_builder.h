#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "castray/scene.h"
#include "scene/file_finder.h"
#include "scene/mesh.h"
#include "scene/transform.h"
#include "scene/warning_list.h"

namespace castray {

struct Raster;

/// What the values of an image stand for: amounts are at least 0, heights are of either sign, and normals n
/// are (1 + n) / 2, or n themselves in an image that has values below 0.
enum class TextureMeaning : std::uint8_t { amounts, heights, normals };

/// Whether instances stay what they are, or become meshes of their own.
enum class Instancing : std::uint8_t { automatic, expand, keep };

/// Gathers a scene's meshes in double, and moves them into scene space at the end.
class SceneBuilder {
 public:
  Scene scene;  ///< all but what `finish` fills in; cameras and lights without size are in the world
  Instancing instancing = Instancing::automatic;  ///< automatic: kept where there are many triangles
  bool environment_given = false;                 ///< else, where nothing emits, the scene gets a white one
  bool is_asset =
      false;  ///< another program's file alone: it gets one, too, where nothing is brighter than it
  WarningList warnings;
  FileFinder files;

  /// Adds a material and returns its index. Throws InputError where there are too many to be numbered.
  std::uint16_t add_material(Material material);

  /// The index of a file's texture, read when first asked for. Throws InputError.
  int add_texture(const std::filesystem::path& file, ColorSpace space,
                  TextureMeaning meaning = TextureMeaning::amounts);

  /// The same of an image within another file, whose bytes are given.
  int add_texture(const TextureSource& source, const std::string& name, std::string_view bytes,
                  ColorSpace space, TextureMeaning meaning);

  /// The index of the texture that `make` returns when `name` is first asked for.
  int add_texture(const std::string& name, const std::function<Texture()>& make);

  /// Notes a key of a file that means nothing here.
  void ignore(const std::filesystem::path& file, std::string_view key);

  /// Adds the mesh of a file, which may have no faces, without its degenerate triangles; with `object`, to
  /// that. What has no name in it gets the file's; names that another mesh of the scene has are numbered.
  void add(Mesh&& mesh, const std::filesystem::path& file, std::optional<std::size_t> object = {});

  /// Adds an object, which is where instances place it; returns its index.
  std::size_t add_object();
  /// Adds an instance of an object, all of the given material if there is one.
  void place(std::size_t object, const Transform& transform, std::optional<std::uint16_t> material = {});

  /// Fills in geometry, center, unit, lights, warnings and the camera, without the triangles that rounding
  /// makes degenerate. Throws InputError where no triangle is left. In finish_scene.cpp.
  Scene finish();

 private:
  /// An object and where it is.
  struct Placed {
    std::size_t object;
    Transform transform;
    std::optional<std::uint16_t> material;  ///< instead of the object's
  };

  int add_raster(const TextureSource& source, const std::string& name, ColorSpace space,
                 TextureMeaning meaning, const std::function<Raster()>& read);
  void join(Mesh& all, Mesh&& more) const;
  void add_to_scene(Mesh&& mesh);
  void make_objects_of_materials();
  /// Materials for what of principled ones is glass.
  void add_glass_shares();
  void expand_instances();
  void expand(const Mesh& object, const Transform& transform);
  /// Drops the degenerate triangles of a mesh and warns of them, in `file` where the mesh knows no place.
  void drop_degenerate(Mesh& mesh, const std::filesystem::path& file);
  void warn_of_dropped(TriangleFault fault, const SourcePlace& place, std::uint64_t count);
  void find_scene_space();
  void move_to_scene_space();
  void round_positions();
  void warn_of_rounding();
  void warn_of_missing_uvs();
  void drop_flat();  ///< what rounding has made so
  void require_triangles() const;
  bool needs_sky() const;
  void move_lights_to_scene_space();
  void place_cameras();

  Mesh mesh_;  ///< what is no object's; in the end, everything
  std::vector<Mesh> objects_;
  std::vector<Placed> instances_;
  std::optional<std::filesystem::path> without_faces_;  ///< the first such file
  std::map<std::string, int> textures_;                 ///< by what they are made of
  std::map<std::string, int> object_names_;             ///< with the next number of each
};

}  // namespace castray
