#include "materials/texture.h"

#include "castray/error.h"

namespace castray {

namespace {

std::array<float, 256> values_of_bytes(const ToneCurve& curve) {
  std::array<float, 256> values;
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(curve.decode(static_cast<float>(i) / 255.f));
  return values;
}

constexpr ToneCurve linear{ToneCurve::Kind::linear, 1};

}  // namespace

const std::array<float, 256>& byte_values(ColorSpace space) {
  static const std::array<float, 256> srgb_values = values_of_bytes({}),
                                      linear_values = values_of_bytes(linear);
  return space == ColorSpace::srgb ? srgb_values : linear_values;
}

Texture make_texture(std::string name, const Image& image) {
  Texture texture{.name = std::move(name),
                  .width = image.width,
                  .height = image.height,
                  .channels = 3,
                  .color_space = ColorSpace::linear};
  texture.floats.reserve(3 * image.pixels.size());
  for (const Vec3f& pixel : image.pixels)
    texture.floats.insert(texture.floats.end(), {pixel.x, pixel.y, pixel.z});
  return texture;
}

Texture make_texture(std::string name, Raster&& raster, ColorSpace space) {
  const auto channels = static_cast<std::size_t>(raster.channels);
  if (raster.encoded && space == ColorSpace::srgb)
    for (std::size_t i = 0; i < raster.floats.size(); ++i)
      if (const bool is_alpha = raster.has_alpha() && i % channels == channels - 1; !is_alpha)
        raster.floats[i] = static_cast<float>(ToneCurve{}.decode(raster.floats[i]));
  return {.name = std::move(name),
          .width = raster.width,
          .height = raster.height,
          .channels = raster.channels,
          .color_space = space,
          .bytes = std::move(raster.bytes),
          .floats = std::move(raster.floats)};
}

Texel texel(const Texture& texture, std::size_t index) {
  Texel texel;
  for (std::size_t c = 0; c < texel.size(); ++c) texel[c] = texel_channel(texture, index, c);
  return texel;
}

float greatest_value(const Texture& texture) {
  float greatest = 0;
  const auto count = static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t channel = 0; channel < 3; ++channel)
      greatest = std::max(greatest, texel_channel(texture, i, channel));
  return greatest;
}

Vec3d mean_color(const Texture& texture, const TextureMap& map) {
  const auto count = static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
  std::array<double, 4> mean{};
  for (std::size_t i = 0; i < count; ++i) {
    const Texel t = texel(texture, i);
    for (std::size_t c = 0; c < 4; ++c) mean[c] += t[c] / static_cast<double>(count);
  }
  return picked<double>(map, [&](std::size_t channel) { return mean[channel]; });
}

}  // namespace castray
