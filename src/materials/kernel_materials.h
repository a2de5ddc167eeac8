#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "castray/scene.h"
#include "materials/descriptor.h"
#include "materials/lobe_albedo.h"

namespace castray {

/// A material's values, by ParameterSlot.
using MaterialValues = std::array<double, parameter_floats>;

/// A scene's materials as the kernels read them. Points into itself and into the scene.
class KernelMaterials {
 public:
  explicit KernelMaterials(const Scene& scene);
  KernelMaterials(const KernelMaterials&) = delete;
  KernelMaterials& operator=(const KernelMaterials&) = delete;

  MaterialTables tables() const;

  std::vector<KernelMaterial> materials;  ///< light_density is left to who knows the lights
  std::vector<KernelDetail> details;
  std::vector<KernelAlbedo> albedos;

 private:
  void add(const Scene& scene, const Material& m);
  /// The table of the lobe's albedo, and what the model makes of the values with it.
  void look_up_lobe(const Material& m, KernelMaterial& k, MaterialValues& values);
  void look_up_coat(const Material& m, KernelMaterial& k, MaterialValues& values);
  void add_maps(const Scene& scene, const Material& m, KernelDetail& detail, KernelMaterial& k);
  /// Those that say how lobes lie, and how far from round they are.
  void add_lobe_maps(const Scene& scene, const Material& m, KernelDetail& detail);
  std::uint32_t albedo_offset(const LobeWidths& widths, const LobeAlbedo& lobe);
  std::vector<KernelMap> maps_of(const Scene& scene, const Material& m);
  KernelMap map_of(const Scene& scene, const TextureMap& map);
  KernelTexture kernel_texture(const Texture& texture);

  std::uint32_t albedo_rows();  ///< the offset of LobeAlbedoRows
  /// A map that bends normals or turns lobes, its gain and base times these; null where there is none.
  const KernelMap* single_map(const Scene& scene, const TextureMap& map, float gain, float base = 1);

  LobeAlbedos lobes_;
  std::map<LobeWidths, std::uint32_t> albedo_offsets_;
  std::optional<std::uint32_t> first_row_;
  std::deque<std::vector<KernelMap>> maps_;  ///< of each of `details`
  bool filtered_ = false, stretched_by_images_ = false;
  std::deque<std::array<std::uint8_t, 8>> small_images_;  ///< of fewer than four bytes
};

}  // namespace castray
