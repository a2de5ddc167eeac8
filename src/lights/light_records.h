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
  uint32_t source;    ///< the scene's triangle, if it is one
  float corner[2];    ///< of a triangle: the barycentrics of its origin in the source, and
  float step;         ///< what both grow by along its edges; (0,0) and 1 where it is all of it
  uint32_t two_sided;
  float error;    ///< bound of the distance of a computed point from the exact light
  float density;  ///< area pdf of power-proportional sampling; used for MIS even when importance chose the
                  ///< light
  float probability;   ///< of this light, chosen by power
  float cumulative;    ///< sum of the probabilities before this one
  uint32_t rectangle;  ///< 1: its edges are perpendicular
  uint32_t node;       ///< of the light tree's cut, for MIS weights; where LightRegions are known
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

/// A region of space, or a plane that parts it in two. `link`: the axis of the plane + 4 times the first of
/// two children, which are side by side; the second holds the places with coordinates from `plane` on. Or
/// region_leaf + 4 times the region's number.
struct RegionNode {
  float plane;
  uint32_t link;
};
inline constexpr uint32_t region_leaf = 3;

/// The region of a surface point is that of the place this far in front of it. It keeps the two sides of a
/// thin wall apart.
inline constexpr float light_front = 0x1p-7f;

/// What share of light samples is chosen by what is seen from the region; the others by bounds alone.
inline constexpr float learned_share = 0.875f;

/// What was learned about the nodes of the cut in regions of space. Tables have rows of most_light_cut.
struct LightRegions {
  const RegionNode* tree;  ///< the root first; null: nothing is known
  const float* seen;       ///< by region and node: 0 if the node is never seen, up to 1
  const float* density;    ///< by region and node: pdf of light samples over that of power-proportional ones
  const float* inverse_power;         ///< by node: 1 over its share of all power
  const uint32_t* node_of_primitive;  ///< of facets or triangles that emit
};

/// Light from outside the scene; see lights/environment.h.
struct EnvironmentTable {
  float constant[3];       ///< radiance from everywhere, or the mean of the image
  bool shines;             ///< it is not black
  uint32_t width, height;  ///< of the image; 0: it is constant
  float turn;              ///< in [0,1): what is added to a direction's longitude to find its column
  const float* radiance;   ///< red, green, blue of each texel, the row at +y first
  const float* rows;       ///< height + 1 cumulative probabilities
  const float* columns;    ///< width + 1 of each row
};

/// A DeltaLight. Point lights are spots of a cone that is all directions.
struct KernelDelta {
  float at[3];         ///< its position; of a directional light the unit direction to it
  float intensity[3];  ///< as DeltaLight::intensity
  float axis[3];
  float cos_outer, inverse_width;  ///< 1 / (cos_inner - cos_outer)
  uint32_t infinite;               ///< 1: directional
};
struct DeltaList {
  const KernelDelta* lights;
  uint32_t count;
};

/// The image of a light in a flat mirror: a parallelogram behind it, larger by what a rough mirror blurs.
struct MirroredLight {
  float origin[3], edge1[3], edge2[3];
  float across1[3], across2[3];  ///< a point p of it has the coordinates dot(across, p - origin), in [0,1]
  float normal[3];               ///< unit; the side that shines
  float center[3], radius;       ///< of a sphere around it
  float area, power;             ///< power: of the light, over the greatest one's
  float plane[3], offset;        ///< of the mirror: it reflects the light to where dot(plane, p) > offset
  float mirror_center[3], mirror_half[3];  ///< the mirror's bounding box
  uint32_t two_sided;
};
inline constexpr int most_mirrored_lights = 8;
struct MirroredLightList {
  const MirroredLight* lights;
  int count;
};

/// An EmissionGuide. Directions fall in bins on the faces +x, -x, +y, -y, +z, -z of a cube, each of them
/// guide_steps x guide_steps squares.
inline constexpr uint32_t guide_step_bits = 3, guide_steps = 1 << guide_step_bits;
inline constexpr uint32_t guide_bins = 6 * guide_steps * guide_steps;
inline constexpr uint32_t guide_search = 4 * guide_steps * guide_steps;  ///< a power of two below guide_bins
inline constexpr uint32_t no_guide = 0xffffffff;
struct EmissionGuideTable {
  const uint32_t* row_of_cell;  ///< or no_guide; x varies fastest. Null: nothing is known
  const float* cumulative;      ///< of each row guide_bins + 1 probabilities, from 0 to 1
  float lower[3], cells_per_unit;
  uint32_t cells[3];
};

/// An ArrivalGuide: leaves of the tree are rows of `cumulative`, as of EmissionGuideTable.
struct ArrivalGuideTable {
  const RegionNode* tree;  ///< the root first; null: nothing is known
  const float* cumulative;
};

struct MaterialTables;
struct TriangleTable;

/// EmissionCells, as kernels read them.
inline constexpr uint32_t no_cells = 0xffffffff;
struct CellTable {
  const uint32_t* first;  ///< by triangle, into `shares`, or no_cells; null: no triangle has any
  const float* shares;    ///< of the lower and the upper half of each square of a grid of steps x steps
  float steps;
};

/// All lights of a scene.
struct LightList {
  const KernelLight* lights;
  uint32_t count;
  uint32_t cut_count;       ///< 0: lights are chosen by power, not by importance
  const LightBounds* cut;   ///< nodes of the tree that together hold every light once
  const LightBounds* tree;  ///< pairs of siblings
  DeltaList deltas;
  EnvironmentTable environment;
  bool by_solid_angle;  ///< sample rectangles uniformly in solid angle
  bool may_be_covered;  ///< a surface may lie so close in front of a light that segments must start at the
                        ///< light
  const MaterialTables* materials;  ///< where an image says what some light emits; else null
  const TriangleTable* triangles;   ///< likewise
  CellTable cells;
  LightRegions regions;
  MirroredLightList mirrored;
  EmissionGuideTable emission;
  ArrivalGuideTable arrivals;
};

/// Choices of a light for one opaque surface point, by the numbers u and deep of choose_light.
struct LightChoiceBatch {
  float p[3], normal[3];
  uint32_t count;
  const float *u, *deep;
  uint32_t* light;
  float* probability;  ///< 0 if no light reaches the point
};

}  // namespace castray
