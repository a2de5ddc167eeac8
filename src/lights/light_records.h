#pragma once

#include <stdint.h>

// Lights as kernels read them: plain data, the same for every instruction set.

namespace castray {

/// A parallelogram origin + a edge1 + b edge2, 0 <= a, b <= 1; or the triangle where a + b <= 1.
struct KernelLight {
  float origin[3];
  float edge1[3], edge2[3];
  float normal[3];    ///< unit; the side that emits
  float emission[3];  ///< the mean where an image says it
  float area;
  uint32_t triangle;  ///< 1: a triangle
  uint32_t material;  ///< its number
  uint32_t source;    ///< the scene's triangle, if it is one: its corners are origin, + edge1, + edge2
  uint32_t two_sided;
  float error;    ///< bound of the distance of a computed point from the exact light
  float density;  ///< area pdf of power-proportional sampling; used for MIS even when importance chose the
                  ///< light
  float probability;   ///< of this light, chosen by power
  float cumulative;    ///< sum of the probabilities before this one
  uint32_t rectangle;  ///< 1: its edges are perpendicular
};
inline constexpr int light_floats = sizeof(KernelLight) / sizeof(float);

/// Bounds of lights: a bounding sphere; a cone around the normals of their emitting sides, as cosine and
/// sine of its half angle (0 and 1 above 90 degrees); and their power.
struct LightBounds {
  float center[3], radius;
  float axis[3], cos_spread;
  float sin_spread, power;
  uint32_t next;  ///< the children's pair in the tree, or light_leaf + the light
  uint32_t pad;
};
inline constexpr uint32_t light_leaf = 0x80000000u;

/// Most nodes of the cut, whose importances are all computed before the descent.
inline constexpr int most_light_cut = 32;

struct MaterialTables;
struct TriangleTable;

/// All lights of a scene.
struct LightList {
  const KernelLight* lights;
  uint32_t count;
  uint32_t cut_count;       ///< 0: lights are chosen by power, not by importance
  const LightBounds* cut;   ///< nodes of the tree that together hold every light once
  const LightBounds* tree;  ///< pairs of siblings
  float environment[3];     ///< radiance from every direction that hits nothing
  bool has_environment;     ///< it is not black
  bool by_solid_angle;      ///< sample rectangles uniformly in solid angle
  bool may_be_covered;  ///< a surface may lie so close in front of a light that segments must start at the
                        ///< light
  const MaterialTables* materials;  ///< where an image says what some light emits; else null
  const TriangleTable* triangles;   ///< likewise
};

}  // namespace castray
