#pragma once

#include <cstdint>

#include "castray/vec.h"

namespace castray {

/// How points of the image become rays.
enum class Projection : std::uint8_t {
  perspective,   ///< through one point, or through a thin lens
  orthographic,  ///< all in direction `forward`, from the plane through the camera's position
  panorama,      ///< the whole sphere in longitude and latitude: `forward` in the middle, `up` at the top
};

/// A thin lens, perpendicular to the view direction, in the camera's place.
struct Lens {
  double radius = 0;          ///< 0: a pinhole; of a polygon: where its corners lie
  double focus_distance = 1;  ///< > 0, along the view direction, to the plane that is in focus
  int blades = 0;             ///< the aperture is a regular polygon of so many sides; 0: a disc
  double rotation = 0;        ///< of the polygon, degrees, clockwise in the image; 0: a corner is at the top

  /// The point of the lens, in radii to the right and up, of two random numbers in [0,1): uniform in area,
  /// and the middle for (0,0).
  struct Point {
    double right, up;
  };
  Point sample(double u, double v) const;
};

inline constexpr int most_blades = 64;

/// The direction is not of unit length.
struct CameraRay {
  Vec3d origin, direction;
};

/// Right-handed; `right` = `forward` x `up`. All of unit length and mutually orthogonal.
struct Camera {
  Vec3d position;
  Vec3d forward{0, 0, 1}, right{-1, 0, 0}, up{0, 1, 0};
  double tan_half_fov = 0.36397023426620234;  ///< of the vertical field of view; perspective
  Projection projection = Projection::perspective;
  double half_height = 1;  ///< of what the image shows; orthographic
  /// How far the image moves, in widths to the right and heights upwards, without a turn of the camera; not
  /// of a panorama.
  double shift_x = 0, shift_y = 0;
  Lens lens;  ///< perspective

  bool has_lens() const { return projection == Projection::perspective && lens.radius > 0; }

  /// The direction (not of unit length) through the pinhole, or the middle of the lens, of sample (px,py) in
  /// [0,width)x[0,height), y downwards; perspective.
  Vec3d direction(double px, double py, int width, int height) const {
    return in_plane(px, py, width, height, tan_half_fov) + forward;
  }

  /// The ray of that sample through the point of the lens that two numbers in [0,1) choose.
  CameraRay ray(double px, double py, int width, int height, double lens_u, double lens_v) const;

  /// The place of that sample in a plane across the view, from the point in line with the view direction,
  /// where the image's half height is `half`.
  Vec3d in_plane(double px, double py, int width, int height, double half) const {
    const double x = (2 * px / width - 1 + 2 * shift_x) * half * width / height;
    const double y = (1 - 2 * py / height + 2 * shift_y) * half;
    return right * x + up * y;
  }
};

/// `rest`, with this view: `position`, `look_at` and `up` in one space; fov vertical, in degrees. Throws
/// InputError where they define no view.
Camera make_camera(const Vec3d& position, const Vec3d& look_at, const Vec3d& up, double fov,
                   const Camera& rest = {});

}  // namespace castray
