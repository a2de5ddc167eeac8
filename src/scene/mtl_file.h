#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "castray/vec.h"
#include "scene/texture_statement.h"
#include "scene/warning_list.h"

namespace castray {

/// The images of a material, by what they change.
enum class MtlMap : unsigned char {
  kd,
  ks,
  ke,
  ns,
  roughness,
  metallic,
  sheen,
  clearcoat,
  clearcoat_roughness,
  dissolve,
  normal,
  bump,
  anisotropy,
  anisotropy_rotation
};
inline constexpr int mtl_maps = 14;

/// What an MTL file says of one material; scene/mtl_material.h says what that means.
struct MtlMaterial {
  std::string name;
  SourcePlace place;
  std::optional<Vec3d> kd{}, ks{}, ke{}, tf{};
  std::optional<double> ns{}, ni{}, dissolve{}, transparency{}, roughness{}, metallic{}, sheen{}, clearcoat{},
      clearcoat_roughness{}, anisotropy{}, anisotropy_rotation{};
  std::optional<int> illum{};
  std::array<std::optional<TextureStatement>, mtl_maps> maps{};

  const std::optional<TextureStatement>& map(MtlMap m) const { return maps[static_cast<std::size_t>(m)]; }
  std::optional<TextureStatement>& map(MtlMap m) { return maps[static_cast<std::size_t>(m)]; }
};

struct MtlFile {
  std::filesystem::path path;
  bool from_blender = false;  ///< by the comment in its first line
  std::vector<MtlMaterial> materials;
  std::vector<std::string> ignored;  ///< keys that mean nothing here, each once
};

/// Reads an MTL file, or the text that is its content. Warns of what is odd; throws InputError with file,
/// line and column of what is broken.
MtlFile parse_mtl(std::string_view text, const std::filesystem::path& file, WarningList& warnings);
MtlFile read_mtl(const std::filesystem::path& file, WarningList& warnings);

}  // namespace castray
