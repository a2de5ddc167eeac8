#include <stb/stb_easy_font.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "castray/metrics.h"

namespace castray {

namespace {

constexpr double lowest = 1e-3;
constexpr int decades = 3, bar_height = 10, label_height = 12, least_width = 150;

/// Black, violet, red, orange, pale yellow: luminance rises all the way, so that it also reads in grey.
Vec3f heat_colour(double t) {
  constexpr std::array<Vec3f, 5> stops{
      Vec3f(0, 0, 0), {.30f, .05f, .42f}, {.77f, .18f, .27f}, {.98f, .60f, .15f}, {1, .98f, .80f}};
  const double at = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const auto f = static_cast<float>(at - static_cast<double>(i));
  return stops[i] * (1 - f) + stops[i + 1] * f;
}

double scale_position(double error) { return std::log10(std::max(error, lowest) / lowest) / decades; }

double pixel_error(const Vec3f& x, const Vec3f& r) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double difference = double(x[c]) - r[c];
    sum += difference * difference / (double(r[c]) * r[c] + 0.01);
  }
  return std::sqrt(sum / 3);
}

void draw_text(Image& image, int left, int top, const char* text) {
  struct Corner {
    float x, y, z;
    unsigned char colour[4];
  };
  std::array<std::array<Corner, 4>, 400> quads{};
  const int count = stb_easy_font_print(0, 0, const_cast<char*>(text), nullptr, quads.data(), sizeof quads);
  for (int i = 0; i < count; ++i) {
    const auto& quad = quads[static_cast<std::size_t>(i)];
    for (int y = static_cast<int>(quad[0].y); y < static_cast<int>(quad[2].y); ++y)
      for (int x = static_cast<int>(quad[0].x); x < static_cast<int>(quad[2].x); ++x)
        if (left + x < image.width && top + y < image.height) image.at(left + x, top + y) = Vec3f(.9f);
  }
}

void draw_bar(Image& image, int top) {
  for (int y = 0; y < bar_height; ++y)
    for (int x = 0; x < image.width; ++x) image.at(x, top + y) = heat_colour((x + 0.5) / image.width);
  constexpr std::array<const char*, decades + 1> labels{"0.001", "0.01", "0.1", "1"};
  for (int i = 0; i <= decades; ++i) {
    const char* label = labels[static_cast<std::size_t>(i)];
    const int width = stb_easy_font_width(const_cast<char*>(label));
    draw_text(image, std::clamp(i * image.width / decades - width / 2, 1, image.width - width - 1),
              top + bar_height + 2, label);
  }
}

}  // namespace

Image heat_map(const Image& image, const Image& reference) {
  Image map(std::max(image.width, least_width), image.height + 2 + bar_height + label_height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      map.at(x, y) = heat_colour(scale_position(pixel_error(image.at(x, y), reference.at(x, y))));
  draw_bar(map, image.height + 2);
  return map;
}

}  // namespace castray
