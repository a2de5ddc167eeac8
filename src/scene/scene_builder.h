#pragma once

#include <string>

#include "castray/scene.h"
#include "scene/mesh.h"

namespace castray {

/// Gathers a scene's meshes in double, and moves them into scene space at the end.
class SceneBuilder {
 public:
  Scene scene;  ///< all but what `finish` fills in: geometry, lights, the camera's place

  /// Adds a material and returns its index. Throws InputError where there are too many to be numbered.
  std::uint16_t add_material(Material material);

  void add(Mesh&& mesh);

  /// Drops degenerate triangles and fills in geometry, center, unit and lights. Throws InputError where no
  /// triangle is left.
  Scene finish();

 private:
  void drop_nonfinite();
  void find_scene_space();
  void round_positions();
  void drop_flat();
  void keep_triangles(const std::vector<bool>& keep);

  Mesh mesh_;
};

}  // namespace castray
