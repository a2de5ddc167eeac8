#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "castray/surface_parameter.h"
#include "castray/vec.h"

namespace castray {

/// How the values of a texture's bytes stand for light: by the curve of IEC 61966-2-1, as colours are stored,
/// or in proportion, as data are (roughness, normals, coverage). Alpha is always linear.
enum class ColorSpace : std::uint8_t { srgb, linear };

/// Where a texture comes from.
struct TextureSource {
  std::filesystem::path file{};  ///< empty: castray made it
  int image = -1;                ///< its number among the images that a glTF file holds; -1: the file is it
};

/// An image on a surface, top row first, bilinear between the centres of its texels. Its lower left corner is
/// (u,v) = (0,0), its upper right one (1,1). What was stored in 8 bits stays in 8 bits.
struct Texture {
  std::string name;
  int width = 0, height = 0;
  int channels = 3;                           ///< side by side: grey; grey, alpha; RGB; or RGB, alpha
  ColorSpace color_space = ColorSpace::srgb;  ///< of `bytes`
  std::vector<std::uint8_t> bytes{};          ///< width * height * channels; or, if empty,
  std::vector<float> floats{};                ///< as many linear values; below 0 only as heights
  TextureSource source{};
};

/// What a camera ray reads of an image: the value at the point that it meets, or the mean of values all over
/// what its pixel sees of the surface there (materials/footprint.h).
enum class TextureFilter : std::uint8_t { none, pixel };

/// How an image gives a parameter its value at a texture coordinate (u,v):
///
///     constant of the material * (base + gain * texel(scale * (u,v) + offset))
///
/// For `normal` gain is the strength, a factor of the normal's tilt; for `bump` it is the height of the value
/// 1 in units of the world. A triangle without texture coordinates has the constant alone.
struct TextureMap {
  int texture = -1;  ///< index into Scene::textures, or -1: no image
  std::array<float, 2> scale{1, 1}, offset{0, 0};
  bool clamp = false;  ///< outside the image its border goes on; otherwise the image repeats
  Channel channel = Channel::color;
  float base = 0, gain = 1;
  TextureFilter filter = TextureFilter::none;  ///< `pixel`: of colours of reflection and transmission alone

  bool used() const { return texture >= 0; }
  bool operator==(const TextureMap&) const = default;
};

/// One material. Colours are linear RGB reflectances in [0,1]; `ke` is emitted radiance, >= 0. Each type
/// reads the parameters that docs/materials.md names.
struct Material {
  std::string name;
  MaterialType type = MaterialType::diffuse;
  Vec3d kd{0.5, 0.5, 0.5};           ///< diffuse: albedo; microfacet, principled: albedo of the diffuse base
  Vec3d ks{0, 0, 0};                 ///< microfacet, principled: Schlick's F0
  Vec3d reflectance{0.8, 0.8, 0.8};  ///< conductor: Fresnel reflectance; with an index, that straight on
  Vec3d eta{0, 0, 0};            ///< conductor, metal of principled: complex index of refraction eta + i k,
  Vec3d k{0, 0, 0};              ///< of red, green and blue light; eta 0: there is none
  Vec3d transmittance{1, 1, 1};  ///< dielectric: tint of what passes through the surface
  Vec3d ke{0, 0, 0};             ///< emitted radiance
  Vec3d absorption{0, 0, 0};     ///< dielectric, principled: inside it, over a unit of length of the files
  double alpha = 0;              ///< GGX width; 0 is perfectly smooth
  /// Conductor, principled, in [0,0.99]: where it is a, the width is alpha / sqrt(1 - a) in the direction in
  /// which u grows, turned by so many degrees towards that of v, and alpha sqrt(1 - a) across it. As factors
  /// of an image any numbers: the product counts.
  double anisotropy = 0, anisotropy_rotation = 0;
  double metallic = 0;             ///< principled, [0,1]: the metal's share
  double transmission = 0;         ///< principled, [0,1]: the share of what is no metal that is glass
  double sheen = 0;                ///< principled, [0,1]
  double clearcoat = 0;            ///< principled, [0,1]: the share that the coat covers
  double clearcoat_roughness = 0;  ///< principled, [0,1]
  double clearcoat_ior = 1.5;      ///< principled: index of the coat, by which it reflects straight on
  double coverage = 1;             ///< [0,1]: the share of the surface that is there
  bool correlated_masking = true;  ///< false, reference integrator only: to compare with renderers without
  double ior = 1.5;   ///< dielectric, glass of principled: index inside (where the normal points away from)
                      ///< over outside
  bool thin = false;  ///< dielectric: two such surfaces close together, and nothing inside
  bool two_sided_emission = false;
  bool multiple_scattering = false;  ///< metals: add what facets reflect more than once
  bool vertex_colors = false;        ///< Scene::colors multiply kd where the triangle has them
  int back = -1;   ///< index into Scene::materials of what the surface is where the normal points away from;
                   ///< -1: the same on both sides
  int glass = -1;  ///< principled: index into Scene::materials of the dielectric that its surface is at some
                   ///< points, by glass_share(); SceneBuilder makes it; -1: none
  bool is_glass_share = false;   ///< it is the `glass` of another material
  bool emits_backwards = false;  ///< `ke` leaves on the side that the normal points away from alone: it is
                                 ///< the `back` of a pair

  std::array<TextureMap, surface_parameters> maps{};  ///< by SurfaceParameter

  TextureMap& map(SurfaceParameter p) { return maps[static_cast<std::size_t>(p)]; }
  const TextureMap& map(SurfaceParameter p) const { return maps[static_cast<std::size_t>(p)]; }
  /// Whether an image changes more than what of the surface is there.
  bool has_maps_of_values() const {
    for (std::size_t p = 0; p < maps.size(); ++p)
      if (maps[p].used() && p != static_cast<std::size_t>(SurfaceParameter::coverage)) return true;
    return false;
  }
  bool has_maps() const {
    for (const TextureMap& map : maps)
      if (map.used()) return true;
    return false;
  }
  /// Whether an image is read by pixels.
  bool filters_maps() const {
    for (const TextureMap& map : maps)
      if (map.used() && map.filter != TextureFilter::none) return true;
    return false;
  }
  /// Whether an image changes alpha.
  bool has_alpha_map() const {
    return map(SurfaceParameter::alpha).used() || map(SurfaceParameter::roughness).used();
  }
  /// Whether an image says how far from round a lobe is, or how it lies.
  bool has_lobe_map() const {
    return map(SurfaceParameter::anisotropy).used() || map(SurfaceParameter::anisotropy_rotation).used() ||
           map(SurfaceParameter::anisotropy_direction).used();
  }
  /// Whether a principled one is all metal, maybe under a coat.
  bool is_bare_metal() const { return metallic == 1 && !map(SurfaceParameter::metallic).used(); }
  /// Whether an image changes what is emitted on the mean, ke times coverage.
  bool has_emission_map() const {
    return emits() && (map(SurfaceParameter::ke).used() || map(SurfaceParameter::coverage).used());
  }
  /// Whether rays may pass as if nothing were there.
  bool may_have_holes() const {
    return coverage < 1 || map(SurfaceParameter::coverage).used() || is_window();
  }
  /// Whether light passes unbent, so that a ray may take no notice of it. What shines by itself does not: the
  /// share of it that is there would not depend on the place alone.
  bool is_window() const { return type == MaterialType::dielectric && thin && !emits(); }
  /// Whether it is one through which colours pass differently well.
  bool tints() const {
    const bool grey = transmittance.x == transmittance.y && transmittance.y == transmittance.z;
    return is_window() && (!grey || map(SurfaceParameter::transmittance).used());
  }
  /// Whether its surface bounds a body that light goes into.
  bool bounds_body() const { return type == MaterialType::dielectric && !thin; }
  bool absorbs() const { return bounds_body() && max_component(absorption) > 0; }
  bool has_back() const { return back >= 0; }
  bool has_glass() const { return glass >= 0; }
  /// The share of its points at which it is `glass`, each by itself.
  double glass_share() const { return has_glass() ? transmission * (1 - metallic) : 0; }
  bool has_index() const { return eta.x > 0; }
  bool emits() const { return ke.x > 0 || ke.y > 0 || ke.z > 0; }
  /// Whether it emits on the side that the normal points to, or on the other.
  bool emits_on(bool front) const { return emits() && (two_sided_emission || front != emits_backwards); }
};

}  // namespace castray
