#include "materials/kernel_materials.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/put.h"
#include "materials/conductor.h"
#include "materials/ggx.h"
#include "materials/lobe_albedo.h"
#include "materials/principled.h"
#include "materials/surface_values.h"

namespace castray {

namespace {

KernelAlbedo kernel_albedo(const LobeAlbedo& albedo) {
  static_assert(LobeAlbedo::intervals == albedo_intervals && LobeAlbedoRows::steps == albedo_row_steps &&
                LobeAlbedoRows::first == first_albedo_row);
  KernelAlbedo k{};
  for (std::size_t i = 0; i <= albedo_intervals; ++i) {
    k.a[i] = static_cast<float>(albedo.nodes()[i].a);
    k.lost[i] = static_cast<float>(albedo.nodes()[i].lost);
  }
  k.mean_a = static_cast<float>(albedo.mean().a);
  k.mean_lost = static_cast<float>(albedo.mean().lost);
  return k;
}

/// Two numbers in [0,1]; see most_of_pair.
float pack(double first, double second) {
  const auto bits = [](double x) { return static_cast<std::uint32_t>(std::lround(x * most_of_pair)); };
  return std::bit_cast<float>(bits(first) | bits(second) << 16);
}

/// How far a lobe is from round; see slot_stretch.
float stretch_of(const Material& m) {
  const double r = lobe_aspect(m);
  return static_cast<float>((1 / r - r) / 2);
}

int stretch_slot(const Material& m) {
  return m.type == MaterialType::conductor ? slot_stretch : slot_layered_stretch;
}

/// What no image and no table changes; of material `index`.
KernelMaterial constants_of(const Scene& scene, const Material& m, std::size_t index) {
  KernelMaterial k{};
  k.coverage = static_cast<float>(m.coverage);
  k.ior = static_cast<float>(m.thin ? -m.ior : m.ior);
  put(k.eta, m.eta);
  put(k.k, m.k);
  const double turn = m.anisotropy_rotation * (pi<double> / 180);
  k.turn[0] = static_cast<float>(std::cos(turn));
  k.turn[1] = static_cast<float>(std::sin(turn));
  put(k.absorption, m.absorption * scene.unit);
  if (m.bounds_body()) k.medium = static_cast<std::uint32_t>(index) + 1;
  k.back =
      static_cast<std::uint32_t>(m.has_back() ? static_cast<std::size_t>(m.back) : index) * material_floats;
  k.glass = static_cast<std::uint32_t>(m.has_glass() ? m.glass : 0) * material_floats;
  k.glass_share = static_cast<float>(m.glass_share());
  k.type = static_cast<std::uint32_t>(m.type);
  k.traits = traits_of(m);
  k.clearcoat_f0 = static_cast<float>(reflectance_of_coat(m.clearcoat_ior));
  return k;
}

/// The values that kernels read of a vertex.
void put_values(const Material& m, const MaterialValues& values, KernelMaterial& k) {
  std::transform(values.begin(), values.begin() + vertex_floats, k.value,
                 [](double v) { return static_cast<float>(v); });
  k.value[slot_metal_sheen] = pack(values[slot_metallic], values[slot_sheen]);
  k.value[slot_coat] = pack(values[slot_clearcoat], values[slot_clearcoat_roughness]);
  if (!(k.traits & trait_stretched)) return;
  const int slot = stretch_slot(m);
  k.stretch = stretch_of(m);
  k.value[slot] = k.stretch;
  k.value[slot + 1] = 0;
}

}  // namespace

KernelMaterials::KernelMaterials(const Scene& scene) {
  for (const Material& m : scene.materials) add(scene, m);
}

void KernelMaterials::add(const Scene& scene, const Material& m) {
  KernelMaterial k = constants_of(scene, m, materials.size());
  MaterialValues values = SurfaceValues<double>(m).value;
  const double least_alpha = (k.traits & trait_specular) ? 0 : Ggx<double>::smooth_below;
  values[slot_alpha] = (k.traits & trait_specular) ? 0 : std::max(values[slot_alpha], least_alpha);

  KernelDetail detail{};
  std::ranges::transform(values, detail.value, [](double v) { return static_cast<float>(v); });
  look_up_lobe(m, k, values);
  look_up_coat(m, k, values);
  put_values(m, values, k);

  detail.type = m.type;
  detail.least_alpha =
      static_cast<float>(has_lobe_rows(m) ? LobeAlbedoRows::alpha_of(LobeAlbedoRows::first) : least_alpha);
  detail.albedo = k.albedo;
  detail.albedo_rows = k.albedo_rows;
  detail.clearcoat_rows = k.clearcoat_rows;
  detail.multiple_scattering = has_lobe_table(m) && m.multiple_scattering;
  if (m.has_index()) put(detail.mean_fresnel, mean_fresnel(m));
  add_maps(scene, m, detail, k);
  materials.push_back(k);
}

void KernelMaterials::look_up_lobe(const Material& m, KernelMaterial& k, MaterialValues& values) {
  const MaterialDescriptor& descriptor = descriptor_of(m.type);
  if (has_lobe_rows(m)) {
    const int row = LobeAlbedoRows::row_of(values[slot_alpha]);
    k.albedo = albedo_rows();
    k.albedo_rows = LobeAlbedoRows::steps;
    values[slot_alpha] = LobeAlbedoRows::alpha_of(row);
    descriptor.finish(m, LobeAlbedoRows::all()[row], values.data());
  } else if (has_lobe_table(m)) {
    const LobeWidths widths = lobe_widths(m, values[slot_alpha]);
    const LobeAlbedo& lobe = lobes_.of(widths);
    k.albedo = albedo_offset(widths, lobe);
    descriptor.finish(m, lobe, values.data());
  }
}

void KernelMaterials::look_up_coat(const Material& m, KernelMaterial& k, MaterialValues& values) {
  if (has_clearcoat_rows(m)) {
    k.clearcoat_albedo = albedo_rows();
    k.clearcoat_rows = LobeAlbedoRows::steps;
    values[slot_clearcoat_roughness] =
        static_cast<double>(clearcoat_row(m.clearcoat_roughness)) / LobeAlbedoRows::steps;
  } else if (m.type == MaterialType::principled) {
    const double alpha = clearcoat_alpha(m.clearcoat_roughness);
    k.clearcoat_albedo = albedo_offset({alpha}, lobes_.of({alpha}));
  }
}

void KernelMaterials::add_maps(const Scene& scene, const Material& m, KernelDetail& detail,
                               KernelMaterial& k) {
  detail.normal = single_map(scene, m.map(SurfaceParameter::normal), 1);
  detail.bump = single_map(scene, m.map(SurfaceParameter::bump), static_cast<float>(1 / scene.unit));
  if (k.traits & trait_stretched) add_lobe_maps(scene, m, detail);
  std::vector<KernelMap> maps = maps_of(scene, m);
  if (maps.empty() && !detail.normal && !detail.bump && !detail.turn && !detail.direction) return;
  maps_.push_back(std::move(maps));
  detail.maps = maps_.back().data();
  detail.count = static_cast<std::uint32_t>(maps_.back().size());
  details.push_back(detail);
  k.detail = static_cast<std::uint32_t>(details.size());
}

void KernelMaterials::add_lobe_maps(const Scene& scene, const Material& m, KernelDetail& detail) {
  const auto turns = static_cast<float>(m.anisotropy_rotation / 360);
  detail.turn = single_map(scene, m.map(SurfaceParameter::anisotropy_rotation), turns, turns);
  detail.direction = single_map(scene, m.map(SurfaceParameter::anisotropy_direction), 1);
  if (m.map(SurfaceParameter::anisotropy).used()) detail.stretch_slot = stretch_slot(m);
  stretched_by_images_ |= m.has_lobe_map();
}

MaterialTables KernelMaterials::tables() const {
  const auto where_any = [this](const auto& has_it) {
    return std::ranges::any_of(materials, has_it) ? materials.data() : nullptr;
  };
  const auto has_any = [&](std::uint32_t trait) {
    return where_any([trait](const KernelMaterial& m) { return (m.traits & trait) != 0; }) != nullptr;
  };
  return {.materials = materials.data(),
          .details = details.data(),
          .albedos = albedos.data(),
          .indices = where_any([](const KernelMaterial& m) { return m.eta[0] > 0; }),
          .absorbing = where_any([](const KernelMaterial& m) {
            return std::ranges::any_of(m.absorption, [](float a) { return a > 0; });
          }),
          .pairs = where_any([this](const KernelMaterial& m) {
            return m.back != static_cast<std::uint32_t>(&m - materials.data()) * material_floats;
          }),
          .glass = where_any([](const KernelMaterial& m) { return m.glass_share > 0; }),
          .filtered = filtered_,
          .stretched = has_any(trait_stretched),
          .stretched_by_images = stretched_by_images_,
          .scatters_again = has_any(trait_scatters_again)};
}

std::uint32_t KernelMaterials::albedo_offset(const LobeWidths& widths, const LobeAlbedo& lobe) {
  const auto [found, is_new] =
      albedo_offsets_.try_emplace(widths, static_cast<std::uint32_t>(albedos.size() * albedo_floats));
  if (is_new) albedos.push_back(kernel_albedo(lobe));
  return found->second;
}

std::uint32_t KernelMaterials::albedo_rows() {
  if (!first_row_) {
    first_row_ = static_cast<std::uint32_t>(albedos.size() * albedo_floats);
    for (const LobeAlbedo& lobe : LobeAlbedoRows::all().rows()) albedos.push_back(kernel_albedo(lobe));
  }
  return *first_row_;
}

const KernelMap* KernelMaterials::single_map(const Scene& scene, const TextureMap& map, float gain,
                                             float base) {
  if (!map.used()) return nullptr;
  KernelMap k = map_of(scene, map);
  if (k.channel == Channel::color) k.channel = Channel::luminance;
  k.gain *= gain;
  k.base *= base;
  return &maps_.emplace_back(1, k).front();
}

std::vector<KernelMap> KernelMaterials::maps_of(const Scene& scene, const Material& m) {
  std::vector<KernelMap> maps;
  if (uses_vertex_colors(m) && !scene.triangle_colors.empty()) {
    KernelMap colors{};
    colors.slot = slot_kd;
    colors.count = 3;
    colors.is_colors = 1;
    maps.push_back(colors);
  }
  for (const MaterialKey& key : descriptor_of(m.type).keys) {
    if (!key.slot || !key.parameter || !m.map(*key.parameter).used()) continue;
    TextureMap map = m.map(*key.parameter);
    if (m.is_window()) map.filter = TextureFilter::none;
    KernelMap k = map_of(scene, map);
    k.slot = *key.slot;
    k.count = floats_of(key);
    k.squared = key.kind == MaterialKey::Kind::squared;
    if (k.count == 1 && k.channel == Channel::color) k.channel = Channel::luminance;
    maps.push_back(k);
  }
  return maps;
}

KernelMap KernelMaterials::map_of(const Scene& scene, const TextureMap& map) {
  KernelMap k{};
  k.texture = kernel_texture(scene.textures[static_cast<std::size_t>(map.texture)]);
  k.by_pixel = map.filter == TextureFilter::pixel && !scene.triangle_uvs.empty();
  filtered_ |= k.by_pixel != 0;
  k.clamp = map.clamp;
  k.channel = map.channel;
  std::ranges::copy(map.scale, k.scale);
  std::ranges::copy(map.offset, k.offset);
  k.base = map.base;
  k.gain = map.gain;
  return k;
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
