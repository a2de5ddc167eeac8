#include "geometry/placement.h"

namespace castray {

Placed::Placed(const SceneInstance& at) : mirrors_(at.mirrors()), translation_(at.translation) {
  for (int i = 0; i < 3; ++i) to_scene_[i] = Vec3d(at.rows[i]);
  const Vec3d columns[3] = {cross(to_scene_[1], to_scene_[2]), cross(to_scene_[2], to_scene_[0]),
                            cross(to_scene_[0], to_scene_[1])};
  const double determinant = dot(to_scene_[0], columns[0]);
  for (int i = 0; i < 3; ++i)
    to_object_[i] = Vec3d{columns[0][i], columns[1][i], columns[2][i]} / determinant;
  growth_ = 1.5 * max_component(spread(to_scene_, spread(to_object_, Vec3d(1))));
}

}  // namespace castray
