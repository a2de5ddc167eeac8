#include <charconv>
#include <cmath>

#include "castray/error.h"
#include "castray/image.h"

namespace castray {

double ToneCurve::encode(double light) const {
  if (!(light > 0)) return 0;
  if (light >= 1) return 1;
  switch (kind) {
    case Kind::linear:
      return light;
    case Kind::gamma:
      return std::pow(light, exponent);
    case Kind::srgb:
      break;
  }
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

double ToneCurve::decode(double value) const {
  switch (kind) {
    case Kind::linear:
      return value;
    case Kind::gamma:
      return std::pow(value, 1 / exponent);
    case Kind::srgb:
      break;
  }
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

ToneCurve parse_tone_curve(const std::string& text) {
  if (text == "srgb") return {};
  if (text == "linear") return {ToneCurve::Kind::linear, 1};
  if (text.starts_with("gamma:")) {
    ToneCurve tone{ToneCurve::Kind::gamma, 0};
    const char* last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data() + 6, last, tone.exponent);
    if (error == std::errc() && end == last && tone.exponent > 0 && std::isfinite(tone.exponent)) return tone;
  }
  throw InputError("unknown tone curve '" + text + "'; use srgb, linear, or gamma:G with G > 0");
}

std::string to_string(const ToneCurve& tone) {
  if (tone.kind == ToneCurve::Kind::srgb) return "srgb";
  if (tone.kind == ToneCurve::Kind::linear) return "linear";
  char digits[32];
  return "gamma:" + std::string(digits, std::to_chars(digits, digits + sizeof digits, tone.exponent).ptr);
}

namespace {

template <class F>
Image map_components(const Image& image, F f) {
  Image result(image.width, image.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) result.pixels[i][c] = static_cast<float>(f(image.pixels[i][c]));
  return result;
}

}  // namespace

Image displayed(const Image& radiance, const Display& display) {
  const double factor = std::exp2(display.exposure);
  return map_components(radiance, [&](float v) { return display.tone.encode(v * factor); });
}

Image decoded(const ImageFile& file, const ToneCurve& tone) {
  if (!file.encoded) return file.image;
  return map_components(file.image, [&](float v) { return tone.decode(v); });
}

}  // namespace castray
