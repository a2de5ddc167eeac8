#include "materials/kernel_materials.h"

#include <algorithm>

#include "materials/ggx.h"
#include "materials/lobe_albedo.h"
#include "materials/texture.h"

namespace castray {

namespace {

using Values = std::array<double, parameter_floats>;

std::size_t floats_of(const MaterialKey& key) { return key.kind == MaterialKey::Kind::color ? 3 : 1; }

Values values_of(const Material& m) {
  Values values{};
  for (const MaterialKey& key : descriptor_of(m.type).keys) {
    if (!key.slot || key.kind == MaterialKey::Kind::squared) continue;
    const Vec3d value = value_of(key, m);
    for (std::size_t c = 0; c < floats_of(key); ++c)
      values[static_cast<std::size_t>(*key.slot) + c] = value[static_cast<int>(c)];
  }
  return values;
}

KernelAlbedo kernel_albedo(const LobeAlbedo& albedo) {
  static_assert(LobeAlbedo::intervals == albedo_intervals);
  KernelAlbedo k{};
  for (std::size_t i = 0; i <= albedo_intervals; ++i) {
    k.a[i] = static_cast<float>(albedo.nodes()[i].a);
    k.b[i] = static_cast<float>(albedo.nodes()[i].b);
  }
  return k;
}

KernelMap map_of(const TextureMap& map, const KernelTexture& texture, const MaterialKey& key) {
  KernelMap k{};
  k.texture = texture;
  k.slot = *key.slot;
  k.count = static_cast<std::int32_t>(floats_of(key));
  k.squared = key.kind == MaterialKey::Kind::squared;
  k.clamp = map.clamp;
  k.channel = k.count == 1 && map.channel == Channel::color ? Channel::luminance : map.channel;
  std::ranges::copy(map.scale, k.scale);
  std::ranges::copy(map.offset, k.offset);
  k.base = map.base;
  k.gain = map.gain;
  return k;
}

}  // namespace

KernelMaterials::KernelMaterials(const Scene& scene) {
  for (const Material& m : scene.materials) add(scene, m);
}

void KernelMaterials::add(const Scene& scene, const Material& m) {
  const MaterialDescriptor& descriptor = descriptor_of(m.type);
  KernelMaterial k{};
  k.coverage = static_cast<float>(m.coverage);
  k.ior = static_cast<float>(m.ior);
  k.type = static_cast<std::uint32_t>(m.type);
  k.traits = traits_of(m);
  Values values = values_of(m);
  const double least_alpha = (k.traits & trait_specular) ? 0 : Ggx<double>::smooth_below;
  values[slot_alpha] = (k.traits & trait_specular) ? 0 : std::max(values[slot_alpha], least_alpha);

  KernelDetail detail{};
  std::ranges::transform(values, detail.value, [](double v) { return static_cast<float>(v); });
  if (descriptor.finish) {
    const LobeAlbedo lobe(values[slot_alpha]);
    k.albedo = albedo_offset(values[slot_alpha], lobe);
    const Vec3d at0 = lobe.mean(Vec3d(0)), at1 = lobe.mean(Vec3d(1));
    detail.mean_albedo[0] = static_cast<float>(at1.x - at0.x);
    detail.mean_albedo[1] = static_cast<float>(at0.x);
    descriptor.finish(lobe, values.data());
  }
  std::transform(values.begin(), values.begin() + vertex_floats, k.value,
                 [](double v) { return static_cast<float>(v); });

  if (std::vector<KernelMap> maps = maps_of(scene, m); !maps.empty()) {
    maps_.push_back(std::move(maps));
    detail.maps = maps_.back().data();
    detail.count = static_cast<std::uint32_t>(maps_.back().size());
    detail.type = m.type;
    detail.least_alpha = static_cast<float>(least_alpha);
    details.push_back(detail);
    k.detail = static_cast<std::uint32_t>(details.size());
  }
  materials.push_back(k);
}

std::uint32_t KernelMaterials::albedo_offset(double alpha, const LobeAlbedo& lobe) {
  const auto [found, is_new] =
      albedo_offsets_.try_emplace(alpha, static_cast<std::uint32_t>(albedos.size() * albedo_floats));
  if (is_new) albedos.push_back(kernel_albedo(lobe));
  return found->second;
}

std::vector<KernelMap> KernelMaterials::maps_of(const Scene& scene, const Material& m) {
  std::vector<KernelMap> maps;
  for (const MaterialKey& key : descriptor_of(m.type).keys) {
    if (key.field == decltype(key.field)(&Material::vertex_colors)) {
      if (!m.vertex_colors || scene.triangle_colors.empty()) continue;
      KernelMap colors{};
      colors.slot = slot_kd;
      colors.count = 3;
      colors.is_colors = 1;
      maps.push_back(colors);
    }
    if (!key.slot || !key.parameter || !m.map(*key.parameter).used()) continue;
    const TextureMap& map = m.map(*key.parameter);
    maps.push_back(map_of(map, kernel_texture(scene.textures[static_cast<std::size_t>(map.texture)]), key));
  }
  return maps;
}

KernelTexture KernelMaterials::kernel_texture(const Texture& texture) {
  KernelTexture k{};
  k.floats = texture.floats.data();
  k.values = byte_values(texture.color_space).data();
  k.width = texture.width;
  k.height = texture.height;
  k.channels = texture.channels;
  if (texture.bytes.empty()) return k;
  k.bytes = texture.bytes.data();
  if (texture.bytes.size() < 4) {  // kernels read words of four
    std::ranges::copy(texture.bytes, small_images_.emplace_back().begin());
    k.bytes = small_images_.back().data();
  }
  return k;
}

}  // namespace castray
