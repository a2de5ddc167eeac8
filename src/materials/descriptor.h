#pragma once

#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "castray/material.h"
#include "core/range.h"
#include "materials/kernel_material.h"

namespace castray {

/// One key of a material in a scene file: the field that it sets, and what else is to be known of it.
struct MaterialKey {
  /// `squared`: the field is the square of what is written. `image_only`: there is no constant.
  enum class Kind : unsigned char { color, number, squared, flag, image_only };

  std::string_view name;
  Kind kind;
  std::variant<std::monostate, Vec3d Material::*, double Material::*, bool Material::*> field{};
  Range range{};
  std::optional<SurfaceParameter> parameter{};  ///< that an image can change
  std::optional<ParameterSlot> slot{};          ///< of the kernels' values
  std::string_view text{};                      ///< for the schema, with the default in brackets
  bool brief = false;                           ///< told by `castray info` even where it is the default
  bool optional_in_hash = false;  ///< no part of a scene's hash where it is the default; for keys that came
                                  ///< after films were made
};

class LobeAlbedo;
struct LobeTables;
struct LobeWidths;
template <class T>
struct SurfaceValues;

/// All that is to be known of a material besides its reflection: what files, `info`, hashes, plans and
/// kernels need, in one place.
struct MaterialDescriptor {
  MaterialType type;
  std::string_view name;     ///< in scene files
  std::string_view text;     ///< one sentence, for the schema
  std::string_view formula;  ///< f, for docs/materials.md
  std::vector<MaterialKey> keys;
  std::uint32_t (*traits)(const Material&);  ///< MaterialTrait set, that of emission left out
  /// Its colour, for passes: the share of light from straight on that it scatters, within the model's means.
  Vec3d (*albedo)(const SurfaceValues<double>& values);
  /// Makes of `values`, by ParameterSlot, those that the kernels' model wants; for a model with a lobe whose
  /// albedo is tabulated. Null: they are used as they are.
  void (*finish)(const Material& material, const LobeAlbedo& lobe, double* values) = nullptr;
};

/// All materials, in the order of MaterialType.
const std::vector<const MaterialDescriptor*>& material_descriptors();
const MaterialDescriptor& descriptor_of(MaterialType type);

/// `keys`, and those that every material has.
std::vector<MaterialKey> with_common_keys(std::vector<MaterialKey> keys);

/// The key, with optional_in_hash.
MaterialKey optional_in_hash(MaterialKey key);

MaterialKey vertex_colors_key();

/// The keys of the width of a GGX distribution.
MaterialKey alpha_key();
MaterialKey roughness_key();

/// Of glass, and of what is glass in part.
MaterialKey ior_key();
MaterialKey absorption_key();

/// Of metals, and of lobes of principled materials, that are not round.
MaterialKey anisotropy_key();
MaterialKey anisotropy_rotation_key();
MaterialKey anisotropy_direction_key();

/// Of metals whose facets reflect light more than once.
MaterialKey multiple_scattering_key();

/// All traits of a material.
std::uint32_t traits_of(const Material& material);

/// Whether GGX lobes of this material are perfectly smooth. An image of alpha or roughness never makes one
/// so: its alpha is at least Ggx::smooth_below.
bool has_smooth_lobe(const Material& material);

/// Whether GGX lobes of this material are neither smooth nor round.
bool has_stretched_lobe(const Material& material);

/// What leaves no room for a direction of the lobe in a material that may have `anisotropy`. Of principled
/// ones kernels keep either that direction or what is emitted, and how much of the light a stretched lobe
/// leaves for the base below it is tabulated for one width: an image of the roughness needs bare metal.
enum class AnisotropyConflict { none, emission, roughness_image };
AnisotropyConflict anisotropy_conflict(const Material& material);

/// Ggx::aspect of a material's lobes; 1 where it is smooth, whose direction nothing shows. Where an image
/// says it, the least that may be.
double lobe_aspect(const Material& material);
/// The same where the values are known.
double lobe_aspect(const Material& material, const SurfaceValues<double>& values);

/// By what the albedo of a material's lobe of this alpha is tabulated.
LobeWidths lobe_widths(const Material& material, double alpha);

/// Whether GGX lobes of this material are nearly as narrow as a mirror's, though not smooth.
bool has_narrow_lobe(const Material& material);

/// Whether it has a narrow lobe though points may gather through it: over a base that scatters everywhere.
bool has_narrow_coat(const Material& material);

/// Whether the colours of vertices count for a material of this type that asks for them.
bool uses_vertex_colors(const Material& material);

/// Whether a material's model reads the albedo of its lobe from a table.
bool has_lobe_table(const Material& material);

/// Whether that table is chosen by the alpha of an image (LobeAlbedoRows).
bool has_lobe_rows(const Material& material);

/// Of Channel, as scene files name them.
const std::vector<std::string_view>& channel_names();
/// By TextureFilter.
const std::vector<std::string_view>& filter_names();

/// Whether a metal's index may stand for this colour of a material (Material::eta, k).
bool takes_index(const MaterialKey& key, MaterialType type);

/// Of its value.
int floats_of(const MaterialKey& key);

/// A field's value as up to three numbers.
Vec3d value_of(const MaterialKey& key, const Material& material);

}  // namespace castray
