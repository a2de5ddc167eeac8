#include "scene/gltf_material.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/range.h"
#include "core/warp.h"
#include "materials/descriptor.h"
#include "materials/media.h"
#include "materials/texture.h"
#include "scene/gltf_lobe.h"
#include "scene/gltf_value.h"
#include "scene/names.h"

namespace castray {

namespace {

using Parameter = SurfaceParameter;
constexpr std::string_view materials = "materials";

/// All that a material says of images, the base colour first.
struct GltfTextures {
  const tinygltf::Material& m;
  const tinygltf::Value* gloss = find_extension(m.extensions, "KHR_materials_pbrSpecularGlossiness");
  const tinygltf::Value* clearcoat = find_extension(m.extensions, "KHR_materials_clearcoat");
  const tinygltf::Value* specular = find_extension(m.extensions, "KHR_materials_specular");
  const tinygltf::Value* stretch = find_extension(m.extensions, "KHR_materials_anisotropy");

  GltfTextureUse base =
      gloss ? texture_use(gloss, "diffuseTexture") : texture_use(m.pbrMetallicRoughness.baseColorTexture);
  GltfTextureUse surface = gloss ? texture_use(gloss, "specularGlossinessTexture")
                                 : texture_use(m.pbrMetallicRoughness.metallicRoughnessTexture);
  GltfTextureUse normal = texture_use(m.normalTexture), emission = texture_use(m.emissiveTexture);
  GltfTextureUse coat = texture_use(clearcoat, "clearcoatTexture");
  GltfTextureUse coat_roughness = texture_use(clearcoat, "clearcoatRoughnessTexture");
  GltfTextureUse specular_color = texture_use(specular, "specularColorTexture");
  GltfTextureUse specular_factor = texture_use(specular, "specularTexture");
  GltfTextureUse direction = texture_use(stretch, "anisotropyTexture");

  /// By the first image that is turned, else by the first.
  GltfUvs uvs() const {
    const GltfTextureUse* chosen = nullptr;
    for (const GltfTextureUse* use : {&base, &surface, &normal, &emission, &coat, &coat_roughness,
                                      &specular_color, &specular_factor, &direction})
      if (use->used() && (!chosen || (use->transform.turns() && !chosen->transform.turns()))) chosen = use;
    if (!chosen) return {};
    return {chosen->uv_set, chosen->transform.turns() ? chosen->transform : UvTransform{}};
  }
};

class GltfMaterialReader {
 public:
  GltfMaterialReader(const GltfDocument& document, std::size_t index, SceneBuilder& builder)
      : document_(document), index_(index), builder_(builder), m_(document.model.materials[index]) {}

  Material read(bool vertex_colors) {
    out_.vertex_colors = vertex_colors;
    set_coverage();
    if (find_extension(m_.extensions, "KHR_materials_unlit")) {
      set_unlit();
    } else if (textures_.gloss) {
      set_specular_glossiness();
    } else {
      set_base_color(m_.pbrMetallicRoughness.baseColorFactor);
      set_metallic_roughness();
    }
    set_map(Parameter::normal, textures_.normal, ColorSpace::linear, Channel::color, TextureMeaning::normals,
            m_.normalTexture.scale);
    return std::move(out_);
  }

 private:
  void warn(const std::string& what) { document_.warn(builder_.warnings, materials, index_, what); }

  double unit(double value, const char* name) {
    if (!(value >= 0 && value <= 1))
      warn(fmt::format("{} {} is outside of 0 .. 1, and clamped", name, value));
    return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 0;
  }

  Vec3d unit(const Vec3d& color, const char* name) {
    return {unit(color.x, name), unit(color.y, name), unit(color.z, name)};
  }

  static double component(const std::vector<double>& values, std::size_t i) {
    return i < values.size() ? values[i] : 1;
  }

  /// Of a number in one channel; not used where there is no image.
  TextureMap map_of(const GltfTextureUse& use, Channel channel) {
    TextureMap map =
        make_map(document_, use, uvs_, ColorSpace::linear, index_, builder_).value_or(TextureMap());
    map.channel = channel;
    return map;
  }

  bool set_map(Parameter parameter, const GltfTextureUse& use, ColorSpace space,
               Channel channel = Channel::color, TextureMeaning meaning = TextureMeaning::amounts,
               double gain = 1) {
    auto map = make_map(document_, use, uvs_, space, index_, builder_, meaning);
    if (!map) return false;
    map->channel = channel;
    map->gain = static_cast<float>(gain);
    out_.map(parameter) = *map;
    return true;
  }

  void set_base_color(const std::vector<double>& factor) {
    out_.kd =
        unit(Vec3d{component(factor, 0), component(factor, 1), component(factor, 2)}, "the base colour");
    set_map(Parameter::kd, textures_.base, ColorSpace::srgb);
  }

  /// The alpha of the base colour counts as coverage, or by its threshold.
  void set_coverage() {
    if (m_.alphaMode == "OPAQUE") return;
    const tinygltf::Value* gloss_factor = find_value(textures_.gloss, "diffuseFactor");
    const double alpha = unit(textures_.gloss ? number_at(gloss_factor, 3, 1)
                                              : component(m_.pbrMetallicRoughness.baseColorFactor, 3),
                              "alpha");
    const bool mask = m_.alphaMode == "MASK";
    if (!mask && m_.alphaMode != "BLEND") warn("unknown alphaMode; it is blended");
    if (set_map(Parameter::coverage, textures_.base, ColorSpace::srgb, Channel::alpha)) {
      TextureMap& map = out_.map(Parameter::coverage);
      // What is interpolated between texels passes the threshold over one step of 8 bits.
      constexpr double steps = 256;
      map.gain = static_cast<float>(mask ? steps * alpha : alpha);
      map.base = mask ? static_cast<float>(1 - steps * m_.alphaCutoff) : 0;
      if (builder_.scene.textures[static_cast<std::size_t>(map.texture)].channels % 2 == 0) return;
      map = {};
    }
    out_.coverage = mask ? (alpha >= m_.alphaCutoff ? 1 : 0) : alpha;
  }

  double emitted(double radiance) const {
    return document_.radiance(materials, index_, "it emits", radiance);
  }

  void set_emission() {
    const auto& factor = m_.emissiveFactor;
    const double strength =
        number_in(find_extension(m_.extensions, "KHR_materials_emissive_strength"), "emissiveStrength", 1);
    for (std::size_t i = 0; i < 3 && i < factor.size(); ++i)
      out_.ke[static_cast<int>(i)] = emitted(factor[i] * strength);
    if (out_.emits()) set_map(Parameter::ke, textures_.emission, ColorSpace::srgb);
    out_.two_sided_emission = m_.doubleSided;
  }

  /// It is seen as it is, and shines.
  void set_unlit() {
    warn("unlit: it emits its base colour, and so lights other surfaces");
    const auto& factor = m_.pbrMetallicRoughness.baseColorFactor;
    out_.kd = {};
    for (std::size_t i = 0; i < 3; ++i) out_.ke[static_cast<int>(i)] = emitted(component(factor, i));
    set_map(Parameter::ke, textures_.base, ColorSpace::srgb);
    out_.two_sided_emission = true;
    out_.vertex_colors = false;
  }

  /// Roughness and its square are equivalent; castray keeps the square.
  void set_roughness(double roughness) { out_.alpha = roughness * roughness; }

  void set_specular_glossiness() {
    const tinygltf::Value* gloss = textures_.gloss;
    out_.type = MaterialType::microfacet;
    out_.kd = unit(vector_in(gloss, "diffuseFactor", Vec3d(1)), "diffuseFactor");
    out_.ks = unit(vector_in(gloss, "specularFactor", Vec3d(1)), "specularFactor");
    const double glossiness = unit(number_in(gloss, "glossinessFactor", 1), "glossinessFactor");
    set_roughness(1 - glossiness);
    set_map(Parameter::kd, textures_.base, ColorSpace::srgb);
    set_map(Parameter::ks, textures_.surface, ColorSpace::srgb);
    if (set_map(Parameter::roughness, textures_.surface, ColorSpace::srgb, Channel::alpha,
                TextureMeaning::amounts, -glossiness)) {
      out_.map(Parameter::roughness).base = 1;
      set_roughness(1);
    }
    set_emission();
  }

  void set_metallic_roughness() {
    const auto& pbr = m_.pbrMetallicRoughness;
    set_roughness(unit(pbr.roughnessFactor, "roughnessFactor"));
    set_map(Parameter::roughness, textures_.surface, ColorSpace::linear, Channel::green);
    set_emission();
    if (set_transmission()) return;
    out_.metallic = unit(pbr.metallicFactor, "metallicFactor");
    if (out_.metallic > 0) set_map(Parameter::metallic, textures_.surface, ColorSpace::linear, Channel::blue);
    set_specular();
    set_sheen();
    set_clearcoat();
    set_anisotropy();
    const bool is_layered =
        out_.sheen > 0 || out_.clearcoat > 0 || out_.transmission > 0 || out_.anisotropy > 0;
    const bool is_coated = out_.ks != Vec3d();
    out_.type = out_.metallic > 0 || is_layered ? MaterialType::principled
                : is_coated                     ? MaterialType::microfacet
                                                : MaterialType::diffuse;
  }

  /// glTF's 0 stands for none.
  double ior() {
    const double n = number_in(find_extension(m_.extensions, "KHR_materials_ior"), "ior", 1.5);
    return n > 0 ? std::min(n, index_range.greatest) : 1.5;
  }

  /// Whether it is glass: where most of the light passes, or all of what a share lets pass otherwise.
  bool set_transmission() {
    const tinygltf::Value* transmission = find_extension(m_.extensions, "KHR_materials_transmission");
    const double share = unit(number_in(transmission, "transmissionFactor", 0), "transmissionFactor");
    if (share == 0) return false;
    const tinygltf::Value* volume = find_extension(m_.extensions, "KHR_materials_volume");
    const bool is_solid = number_in(volume, "thicknessFactor", 0) > 0;
    const bool has_texture = texture_use(transmission, "transmissionTexture").used();
    const bool has_metal_image = m_.pbrMetallicRoughness.metallicFactor > 0 && textures_.surface.used();
    const bool may_blend = !has_texture && !has_metal_image && !out_.emits();
    if (is_solid && share < 1 && may_blend) {
      set_absorption(volume);
      out_.transmission = share;
      out_.ior = ior();
      return false;
    }
    constexpr double glass_from = 0.5;
    if (share < 1 || has_texture)
      warn(fmt::format("transmission is all or nothing: it is {}",
                       share < glass_from ? "left out" : "taken for 1"));
    if (share < glass_from) return false;
    if (is_solid)
      set_solid_glass(volume);
    else
      set_thin_wall();
    return true;
  }

  void set_absorption(const tinygltf::Value* volume) {
    const double distance = number_in(volume, "attenuationDistance", 0);
    const Vec3d color = vector_in(volume, "attenuationColor", Vec3d(1));
    // black would take an infinite coefficient
    const auto clamped = [](double c) { return std::clamp(c, 1e-6, 1.0); };
    if (distance > 0)
      out_.absorption = absorption_of(Vec3d(clamped(color.x), clamped(color.y), clamped(color.z)), distance);
  }

  void set_solid_glass(const tinygltf::Value* volume) {
    set_absorption(volume);
    set_tinted_glass();
  }

  void set_thin_wall() {
    if (out_.alpha > 0) warn("a thin wall of glass is smooth, and does not blur what is behind it");
    set_tinted_glass();
    out_.thin = true;
    out_.alpha = 0;
    out_.map(Parameter::roughness) = {};
    out_.vertex_colors = false;
  }

  void set_tinted_glass() {
    out_.type = MaterialType::dielectric;
    out_.ior = ior();
    out_.transmittance = out_.kd;
    out_.map(Parameter::transmittance) = std::exchange(out_.map(Parameter::kd), {});
  }

  /// Reflectance straight on.
  double f0() {
    const double n = ior();
    return (n - 1) * (n - 1) / ((n + 1) * (n + 1));
  }

  /// Of what is no metal, straight on.
  void set_specular() {
    const Vec3d tint = vector_in(textures_.specular, "specularColorFactor", Vec3d(1)) * f0();
    const double factor = unit(number_in(textures_.specular, "specularFactor", 1), "specularFactor");
    for (int c = 0; c < 3; ++c) out_.ks[c] = std::clamp(tint[c], 0.0, 1.0) * factor;
    const bool has_color = set_map(Parameter::ks, textures_.specular_color, ColorSpace::srgb);
    if (has_color && textures_.specular_factor.used())
      warn("specularTexture is left out beside specularColorTexture");
    else if (!has_color)
      set_map(Parameter::ks, textures_.specular_factor, ColorSpace::linear, Channel::alpha);
  }

  void set_sheen() {
    const tinygltf::Value* sheen = find_extension(m_.extensions, "KHR_materials_sheen");
    const Vec3d color = vector_in(sheen, "sheenColorFactor", Vec3d());
    if (!(max_component(color) > 0)) return;
    warn("sheen is white, of the strength of its colour's luminance, whatever its roughness");
    out_.sheen = std::clamp(luminance(color), 0.0, 1.0);
  }

  /// Where images say widths of the lobe, there is no base below it: see AnisotropyConflict.
  void set_anisotropy() {
    const tinygltf::Value* stretch = textures_.stretch;
    GltfNumber strength{unit(number_in(stretch, "anisotropyStrength", 0), "anisotropyStrength")};
    if (strength.factor == 0) return;
    if (anisotropy_conflict(out_) == AnisotropyConflict::emission)
      return warn("anisotropy is left out beside emission");
    GltfNumber roughness{std::sqrt(out_.alpha), out_.map(Parameter::roughness)};
    GltfNumber metallic{out_.metallic, out_.map(Parameter::metallic)};
    strength.map = map_of(textures_.direction, Channel::blue);
    for (GltfNumber* number : {&roughness, &metallic, &strength}) fold_constant(builder_, *number);
    const bool is_metal = metallic.factor == 1 && !metallic.varies();
    if (roughness.varies() && !is_metal)
      return warn("anisotropy is left out beside an image of the roughness of what is not all metal");
    if (strength.varies() && !(is_metal && lie_alike(roughness, strength))) {
      warn(is_metal ? "the anisotropy's strength is the same everywhere: its image lies otherwise than the "
                      "roughness's"
                    : "the anisotropy's strength is the same everywhere, as it is on what is not all metal");
      strength.map = {};
    }
    out_.metallic = metallic.factor;
    out_.map(Parameter::metallic) = metallic.map;
    out_.map(Parameter::roughness) = roughness.map;
    set_lobe(roughness, strength, builder_, out_);
    out_.anisotropy_rotation = number_in(stretch, "anisotropyRotation", 0) * (180 / pi<double>);
    set_map(Parameter::anisotropy_direction, textures_.direction, ColorSpace::linear, Channel::color,
            TextureMeaning::normals);
  }

  void set_clearcoat() {
    out_.clearcoat = unit(number_in(textures_.clearcoat, "clearcoatFactor", 0), "clearcoatFactor");
    if (out_.clearcoat == 0) return;
    set_map(Parameter::clearcoat, textures_.coat, ColorSpace::linear, Channel::red);
    out_.clearcoat_roughness =
        unit(number_in(textures_.clearcoat, "clearcoatRoughnessFactor", 0), "clearcoatRoughnessFactor");
    set_map(Parameter::clearcoat_roughness, textures_.coat_roughness, ColorSpace::linear, Channel::green);
    if (texture_use(textures_.clearcoat, "clearcoatNormalTexture").used())
      warn("the clear coat has the normals of what is below it");
  }

  const GltfDocument& document_;
  std::size_t index_;
  SceneBuilder& builder_;
  const tinygltf::Material& m_;
  GltfTextures textures_{m_};
  GltfUvs uvs_ = textures_.uvs();
  Material out_;
};

}  // namespace

GltfUvs uvs_of(const GltfDocument& document, int index) {
  if (index < 0) return {};
  return GltfTextures{document.model.materials[static_cast<std::size_t>(index)]}.uvs();
}

Material make_material(const GltfDocument& document, int index, bool vertex_colors, SceneBuilder& builder) {
  if (index >= 0)
    return GltfMaterialReader(document, static_cast<std::size_t>(index), builder).read(vertex_colors);
  return {.name = {},
          .type = MaterialType::principled,
          .kd = Vec3d(1),
          .ks = Vec3d(0.04),
          .alpha = 1,
          .metallic = 1,
          .vertex_colors = vertex_colors};
}

std::vector<std::string> material_names(const GltfDocument& document) {
  std::vector<std::string> names;
  for (const tinygltf::Material& m : document.model.materials)
    names.push_back(m.name.empty() ? "material" : m.name);
  names.push_back("default");
  return without_repeats(std::move(names));
}

}  // namespace castray
