#pragma once

#include "castray/surface_parameter.h"

// Materials and their images as the kernels read them; plain data, the same for every instruction set.

namespace castray {

/// What the stages have to know of a material; bits of KernelMaterial::traits.
enum MaterialTrait : uint32_t {
  trait_directional = 1,  ///< f depends on the directions: it is not kd / pi everywhere
  trait_specular = 2,     ///< has a perfectly smooth lobe
  trait_transmits = 4,    ///< light passes through the surface
  trait_shareable = 8,  ///< neither specular nor transmitting: many points may gather through one point of it
  trait_emits = 16,
  trait_emits_behind = 32,  ///< on both sides
  trait_bent = 64,          ///< has a normal or bump map
  trait_focuses = 128,  ///< not smooth, but all that it scatters stays in a narrow lobe, or passes through:
                        ///< what light it sends to other surfaces are caustics
  trait_emits_backwards = 256,  ///< on the back alone; never seen from the front
  trait_stretched = 512,        ///< its lobes are not round
  trait_scatters_again = 1024,  ///< principled: its metal adds what facets reflect more than once
  trait_window = 2048,          ///< rays pass as if nothing were there, by Coverage
  trait_smooth = 4096,          ///< all its lobes are perfectly smooth: light samples bring nothing
};

/// Where a surface's values stand in an array of floats. Vertices carry the first vertex_floats of them, as
/// the models want them; the others only shape those.
enum ParameterSlot : int {
  slot_kd = 0,     ///< diffuse, principled: albedo; microfacet: that of the base over 1 - the lobe's mean
                   ///< albedo; dielectric: transmittance; conductor: see scattered_again of conductor.h
  slot_ks = 3,     ///< microfacet, principled: F0; conductor: reflectance
  slot_alpha = 6,  ///< GGX width; 0 where the lobe is treated as perfectly smooth
  slot_emission = 7,
  slot_metal_sheen = 10,     ///< principled: metallic and sheen, as a pair of 16 bits each
  slot_coat = 11,            ///< principled: clearcoat and its roughness, likewise
  slot_layered_stretch = 7,  ///< principled, where its lobes are not round: likewise; they do not emit
  slot_stretch = 10,  ///< conductor: how far its lobe is from round, (1/r - r) / 2 for widths alpha / r and
                      ///< alpha r, times cosine and sine of twice the angle from the shading frame's x
                      ///< axis to where it is wide
  vertex_floats = 12,
  slot_coverage = 12,
  slot_metallic = 13,
  slot_sheen = 14,
  slot_clearcoat = 15,
  slot_clearcoat_roughness = 16,
  slot_anisotropy = 17,
  parameter_floats = 18
};

/// The greatest of a pair's numbers, which stands for 1. The first has the lower 16 bits.
inline constexpr float most_of_pair = 65535;

/// Greatest anisotropy.
inline constexpr float most_anisotropy = 0.99f;

/// Of the square of what an image of directions says; less, between texels that say opposite ones, counts
/// for none.
inline constexpr float least_direction2 = 1e-6f;

/// LobeAlbedo's table.
inline constexpr int albedo_intervals = 128;
struct KernelAlbedo {
  float a[albedo_intervals + 1], lost[albedo_intervals + 1];
  float mean_a, mean_lost;
};
inline constexpr int albedo_floats = sizeof(KernelAlbedo) / sizeof(float);
/// LobeAlbedoRows: so many steps of roughness, of which this is the first.
inline constexpr int albedo_row_steps = 256, first_albedo_row = 3;
/// What a coat leaves for its base on the mean is taken for at least so much.
inline constexpr float least_left_for_base = 1e-4f;

/// The directional albedo of sheen, (1 - wi.h)^5 per steradian (Burley 2012, section 5.5), as a polynomial of
/// the cosine: above the integral by at most 1e-4, so that what is left for the surface below is never too
/// much.
inline constexpr float sheen_albedo_terms[] = {0.08854f, -0.25093f, 0.27183f, -0.13747f, 0.02834f};

/// Least width of a clear coat, never so smooth that light sampling could not find its lobe (Burley 2012).
inline constexpr float least_clearcoat_alpha = 1e-3f;

struct KernelMaterial {
  float value[vertex_floats];  ///< by ParameterSlot, where no image changes them
  float coverage;
  float ior;            ///< of a thin wall, times -1
  float eta[3], k[3];   ///< conductor, principled: complex index of refraction; eta 0: constant reflectance
  float stretch;        ///< how far its lobe is from round, the length of slot_stretch
  float turn[2];        ///< cosine and sine of the angle from where u grows to where lobes are wide
  float absorption[3];  ///< dielectric: inside it, over a unit of length in scene space
  uint32_t medium;      ///< dielectric: 1 + the material's index; else 0
  uint32_t type;        ///< MaterialType
  uint32_t traits;      ///< MaterialTrait set
  uint32_t albedo;      ///< of a lobe with a table: offset in floats into MaterialTables::albedos
  float albedo_rows;    ///< albedo_row_steps where an image gives alpha: rows from `albedo` on; else 0
  uint32_t clearcoat_albedo;  ///< principled: likewise
  float clearcoat_rows;
  float clearcoat_f0;   ///< straight on
  uint32_t back;        ///< what it is where the normal points away from: offset in floats of that record
  uint32_t glass;       ///< what it is at some points: offset of that record
  float glass_share;    ///< of points; 0: none
  uint32_t detail;      ///< index + 1 into MaterialTables::details, or 0
  float light_density;  ///< of a light point on this material by light sampling, per area
};
inline constexpr int material_floats = sizeof(KernelMaterial) / sizeof(float);

/// Where a pixel's footprint is probed (materials/footprint.h): a (0,2)-net of the unit square. Each kernel
/// has a table of its own.
inline constexpr int footprint_probes = 16;
constexpr float footprint_probe[footprint_probes][2] = {
    {0 / 16.f, 0 / 16.f},  {1 / 16.f, 8 / 16.f},   {2 / 16.f, 4 / 16.f},  {3 / 16.f, 12 / 16.f},
    {4 / 16.f, 2 / 16.f},  {5 / 16.f, 10 / 16.f},  {6 / 16.f, 6 / 16.f},  {7 / 16.f, 14 / 16.f},
    {8 / 16.f, 1 / 16.f},  {9 / 16.f, 9 / 16.f},   {10 / 16.f, 5 / 16.f}, {11 / 16.f, 13 / 16.f},
    {12 / 16.f, 3 / 16.f}, {13 / 16.f, 11 / 16.f}, {14 / 16.f, 7 / 16.f}, {15 / 16.f, 15 / 16.f}};

/// Of Footprint: the far end of what a pixel sees counts as no more than 16 times as far away as its middle.
inline constexpr float least_nearing = 1 / 16.f;

/// Texels of 1 to 4 channels side by side, top row first: bytes, of which `values` has the linear value; or
/// linear floats.
struct KernelTexture {
  const uint8_t* bytes;  ///< null: floats
  const float* floats;
  const float* values;  ///< of each byte
  int32_t width, height, channels;
};

/// What multiplies a surface's value in a slot: an image, or the colours of the triangle's vertices. See
/// TextureMap.
struct KernelMap {
  KernelTexture texture;
  int32_t slot;
  int32_t count;       ///< of floats in the slot
  uint32_t is_colors;  ///< 1: the vertices' colours instead of the image
  uint32_t squared;    ///< 1: multiplies twice
  uint32_t clamp;
  uint32_t by_pixel;  ///< 1: TextureFilter::pixel
  Channel channel;
  float scale[2], offset[2];
  float base, gain;
};

/// What of a material changes from point to point.
struct KernelDetail {
  const KernelMap* maps;
  uint32_t count;
  const KernelMap *normal, *bump;     ///< that bend the shading normal; or null
  const KernelMap *turn, *direction;  ///< that turn lobes, `turn` in whole turns; or null
  int32_t stretch_slot;  ///< where an image of slot_anisotropy says how far from round a lobe is; else 0
  MaterialType type;
  float value[parameter_floats];  ///< as the scene has them
  float least_alpha;              ///< where an image says less
  uint32_t albedo;                ///< as the material's
  float albedo_rows, clearcoat_rows;
  uint32_t multiple_scattering;  ///< conductor: 1: facets scatter more than once
  float mean_fresnel[3];         ///< conductor: of its index; 0: it is the reflectance
};

/// All materials of a scene.
struct MaterialTables {
  const KernelMaterial* materials;
  const KernelDetail* details;
  const KernelAlbedo* albedos;
  /// `materials` where one has a complex index, absorbs, has another back, or is glass at some points; else
  /// null.
  const KernelMaterial *indices, *absorbing, *pairs, *glass;
  bool filtered;   ///< whether a map reads the pixels' footprints
  bool stretched;  ///< whether some material has trait_stretched; likewise
  bool stretched_by_images;
  bool scatters_again;
};

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

}  // namespace castray
