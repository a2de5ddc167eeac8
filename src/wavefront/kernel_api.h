#pragma once

#include <stdint.h>

#include "geometry/wide_bvh_view.h"
#include "materials/kernel_material.h"

// What the program and the kernels exchange: plain data and a table of functions, the same for every
// instruction set. Everything is in scene space.

namespace castray {

/// A convex coplanar quad or a triangle of the flat list. Point p of its plane is inside where every
/// edge . (p[u], p[v], 1) >= 0; edges are scaled so that this is a distance in the projection onto axes u and
/// v.
struct Facet {
  float normal[3];  ///< unit; to the counter-clockwise side
  float offset;     ///< normal . p of the plane's points
  float edge[4][3];
  float error;  ///< bound of the distance between a computed hit point and the exact facet
  uint32_t material;
  float corner[4][3];
  uint32_t triangle[2];  ///< of the scene; equal for a triangle
};
inline constexpr int facet_floats = sizeof(Facet) / sizeof(float);

/// The closest hit of one ray by a test that does not err at edges; facet 0xffffffff is a miss.
struct ExactFacets {
  const void* of;
  void (*closest)(const void* of, const float origin[3], const float direction[3], float& t, uint32_t& facet);
};

/// Facets sorted by axis: those of axis a are facets[first[a]] to facets[first[a + 1] - 1].
struct FacetList {
  const Facet* facets;
  uint32_t first[4];
  ExactFacets exact;  ///< of the same facets; only for closest hits
};

/// The facets that can lie between two points of the scene, field by field, padded to a multiple of 16 with
/// copies of the last one.
struct BlockerList {
  const float* corner[4][3];
  const float* normal[3];
  uint32_t count, padded;
};

/// A parallelogram origin + a edge1 + b edge2, 0 <= a, b <= 1; or the triangle where a + b <= 1.
struct KernelLight {
  float origin[3];
  float edge1[3], edge2[3];
  float normal[3];  ///< unit; the side that emits
  float emission[3];
  float area;
  uint32_t triangle;  ///< 1: a triangle
  uint32_t two_sided;
  float error;         ///< bound of the distance of a computed point from the exact light
  float density;       ///< of a point on it by light sampling, per area; what shares between techniques use
  float probability;   ///< of choosing this light by power
  float cumulative;    ///< of the lights before this one
  uint32_t rectangle;  ///< 1: its edges are perpendicular
};
inline constexpr int light_floats = sizeof(KernelLight) / sizeof(float);

/// Bounds of lights: a sphere; a cone that holds the normals of emitting sides, by the cosine and sine of its
/// half angle, 0 and 1 where that is above 90 degrees; and their power.
struct LightBounds {
  float center[3], radius;
  float axis[3], cos_spread;
  float sin_spread, power;
  uint32_t next;  ///< the children's pair in the tree, or light_leaf + the light
  uint32_t pad;
};
inline constexpr uint32_t light_leaf = 0x80000000u;

/// Nodes of a tree that are looked at one by one, before a descent below the chosen one.
inline constexpr int most_light_cut = 32;

struct LightList {
  const KernelLight* lights;
  uint32_t count;
  uint32_t cut_count;       ///< 0: lights are chosen by power, not by what they may bring to a point
  const LightBounds* cut;   ///< nodes that hold all lights, each once
  const LightBounds* tree;  ///< pairs of siblings
  bool by_solid_angle;      ///< points are uniform in solid angle where that can be had
  bool may_be_covered;      ///< something may lie too close in front of one to be seen from afar
};

/// Sample (px,py) of the full image looks along corner + px * dx + py * dy.
struct KernelCamera {
  float position[3];
  float corner[3], dx[3], dy[3];
};

/// Kernels are compiled for sets of these; what a scene does not need is not in its kernel.
enum KernelFeature : uint32_t {
  feature_bvh = 1,        ///< a tree instead of a flat list
  feature_materials = 2,  ///< other than diffuse
  feature_detail = 4,     ///< textures and smooth normals
};

/// Triangles as the scene holds them; what a hit in the tree refers to.
struct TriangleTable {
  const float* positions;          ///< x, y, z of each vertex
  const uint32_t* corners;         ///< three of each triangle
  const uint32_t* materials;       ///< 16 bits a triangle, two in a word, the even one low
  const float* normals;            ///< x, y, z
  const uint32_t* normal_corners;  ///< three of each triangle, 0xffffffff: none; or null
  const float* uvs;                ///< u, v
  const uint32_t* uv_corners;      ///< likewise
  const float* colors;             ///< red, green, blue
  const uint32_t* color_corners;   ///< likewise
};

/// What the camera's rays hit, where they are the same for all samples: a table over the pixels from (x0,y0)
/// on.
struct FirstHits {
  float *t, *b1, *b2;  ///< null: every sample has a ray of its own
  uint32_t* primitive;
  int x0, y0, width, height;
  bool known;  ///< otherwise they are to be found, and nothing rendered
};

/// Bound of the distance by which rounding moves a ray of unit direction that starts in the scene past a
/// facet's edge, and of the product of that and a segment's length.
inline constexpr float list_slack = 0x1p-20f, segment_slack = 4 * list_slack;

struct KernelScene {
  FacetList facets;    ///< all of the scene, if there is no tree
  FacetList blockers;  ///< those that can lie between two points of the scene
  BlockerList blocker_fields;
  WideBvhView bvh;
  TriangleTable triangles;
  const KernelMaterial* materials;
  const KernelDetail* details;
  const KernelAlbedo* albedos;
  LightList lights;
  KernelCamera camera;
  FirstHits first_hits;
  float environment[3];
  float camera_slack;  ///< list_slack for rays from the camera
};

struct KernelOptions {
  bool sobol;
  bool jitter;
  bool fixed_roulette;
  float survival;       ///< of fixed roulette
  uint32_t max_depth;   ///< path edges; 0: no limit
  float most_indirect;  ///< greatest component of a sample's indirect part; infinity: no bound
  bool mis;             ///< emission found by BSDF sampling shares with light sampling
  int suffixes;         ///< of each tile's pixels whose paths are traced on; 0: no sharing
  int light_points;     ///< shared by a tile
  uint64_t ragged;      ///< samples before this one swap pixels across the edges of tiles
  uint32_t seed;        ///< hashed; pixel_key starts from it
};

/// The unit of work: one sample of `tiles` tiles of 8x8 pixels, side by side.
struct TileJob {
  int x, y;            ///< top left pixel in the full image; may lie outside
  int grid_x, grid_y;  ///< the first tile's place in the grid of tiles
  int tiles;
  uint64_t sample;
};

inline constexpr int tile_size = 8;
inline constexpr int tile_pixels = tile_size * tile_size;
inline constexpr int max_tiles = 8;  ///< of a job
inline constexpr int batch_size = tile_pixels * max_tiles;

/// A pixel of a tile of ragged edges lies at most so far outside.
inline constexpr int ragged_reach = tile_size / 2;

/// One job's result: place in the full image, red, green and blue of pixel i of tile k at 64 k + i, and what
/// it took.
struct TileResult {
  uint32_t *x, *y;  ///< as signed numbers, for pixels left of or above the image
  float* radiance[3];
  uint64_t rays;
};

using RenderTiles = void (*)(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch,
                             TileResult&);

/// BSDFs of one material side by side, for directions of its shading frame with wo.z > 0: f |cos| and density
/// of wi, and the sample for the numbers u (lobe, then direction).
struct BsdfBatch {
  uint32_t material;  ///< its index
  bool front;         ///< seen from the side that its normal points to
  uint32_t count;
  const float *wo[3], *wi[3], *u[3];
  float *f_cos[3], *pdf;
  float *sampled_wi[3], *weight[3], *sampled_pdf, *eta2;
  float* specular;  ///< 1: the sample is of a perfectly smooth lobe
};

/// The functions of one instruction set.
struct KernelApi {
  const char* name;  ///< "scalar", "sse4", "avx2", "avx512"
  int width;         ///< lanes
  uint64_t scratch_bytes;
  /// By KernelFeature set; null where none is compiled. `scratch`: scratch_bytes, aligned to 64, of the
  /// calling thread.
  RenderTiles render_tiles[8];
  /// sample_block of core/sequences.h, for samples of the first epoch.
  void (*sample_block)(bool sobol, uint32_t key, uint32_t index, uint32_t block, float* u);
  void (*bvh_closest)(const WideBvhView&, const RayBatch&);      ///< the nearest hit of every ray
  void (*bvh_occluded)(const WideBvhView&, const ShadowBatch&);  ///< whether each ray hits anything
  /// The same over a list, with list_slack or segment_slack: t and facet of the nearest; whether one is at 0
  /// < t < 1.
  void (*facets_closest)(const FacetList&, float slack, const RayBatch&);
  void (*facets_occluded)(const FacetList&, float slack, const ShadowBatch&);
  /// The lane models of the materials of a scene whose materials and albedos are set, images left out.
  void (*evaluate_bsdfs)(const KernelScene&, const BsdfBatch&);
};

namespace scalar {
const KernelApi& kernel_api();
}
namespace sse4 {
const KernelApi& kernel_api();
}
namespace avx2 {
const KernelApi& kernel_api();
}
namespace avx512 {
const KernelApi& kernel_api();
}

}  // namespace castray
