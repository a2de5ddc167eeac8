#include <fmt/format.h>
#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "cli/compare_page.h"
#include "cli/compare_report.h"
#include "cli/shell_word.h"
#include "core/base64.h"

namespace castray::cli {

namespace {

using json = nlohmann::ordered_json;

std::string deflated(const std::vector<half>& values) {
  uLongf size = compressBound(values.size() * sizeof(half));
  std::string bytes(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(values.data()),
                values.size() * sizeof(half), 6) != Z_OK)
    throw std::runtime_error("zlib");
  bytes.resize(size);
  return bytes;
}

half to_half(double v) { return half(static_cast<float>(std::clamp<double>(v, -HALF_MAX, HALF_MAX))); }

/// The reference and the difference of the image from it, as half floats: small differences keep their
/// digits.
void add_pixels(json& item, const Comparison& c) {
  std::vector<half> reference, difference;
  for (std::size_t i = 0; i < c.image.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      reference.push_back(to_half(c.reference.pixels[i][k]));
      difference.push_back(to_half(double(c.image.pixels[i][k]) - c.reference.pixels[i][k]));
    }
  item["reference"] = base64(deflated(reference));
  item["difference"] = base64(deflated(difference));
}

void add_heat_map(json& item, const Comparison& c) {
  const Image map = heat_map(c.image, c.reference);
  item["heat_width"] = map.width;
  item["heat"] = "data:image/png;base64," + base64(encode_png(map, {{ToneCurve::Kind::linear, 1}, 0}));
}

/// At most this many pixels a side, each the mean of those it covers.
constexpr int thumbnail_side = 192;

Image thumbnail(const Image& image) {
  const int step = (std::max(image.width, image.height) + thumbnail_side - 1) / thumbnail_side;
  Image small((image.width + step - 1) / step, (image.height + step - 1) / step);
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      const int x1 = std::min((x + 1) * step, image.width), y1 = std::min((y + 1) * step, image.height);
      Vec3f sum;
      for (int v = y * step; v < y1; ++v)
        for (int u = x * step; u < x1; ++u) sum += image.at(u, v);
      small.at(x, y) = sum / static_cast<float>((x1 - x * step) * (y1 - y * step));
    }
  return small;
}

void add_thumbnail(json& item, const Comparison& c) {
  const Display as_stored{{ToneCurve::Kind::linear, 1}, 0};
  item["thumbnail"] =
      "data:image/png;base64," + base64(encode_png(thumbnail(c.image), c.encoded ? as_stored : c.display));
}

/// Rows of the table: name, value, detail, limit, whether it passes.
json measures_of(const Comparison& c) {
  json rows = json::array();
  for (const Measure& m : c.measures) {
    json row{{"name", m.name},
             {"value", fmt::format("{:.4g}", m.value)},
             {"detail", metric_detail(c.errors, m.name)},
             {"limit", ""}};
    for (const Check& check : c.checks)
      if (check.name == m.name) row["limit"] = check.limit, row["pass"] = check.pass;
    rows.push_back(row);
  }
  for (const Check& check : c.checks) {
    if (check.name == "ztest")
      rows.push_back({{"name", check.name},
                      {"value", fmt::format("p {} {:.3g}", c.noise->differs() ? "<" : "=", c.noise->p)}});
    else if (check.name == "allow-pixels")
      rows.push_back({{"name", check.name}, {"value", fmt::format("{:.4g} %", *c.percent_beyond)}});
    else
      continue;
    rows.back().update({{"detail", ""}, {"limit", check.limit}, {"pass", check.pass}});
  }
  return rows;
}

/// `whole`: with all pixels, even if it passes.
json item_of(const Comparison& c, const std::string& flags, bool whole) {
  const std::string files = shell_word(c.image_file.string()) + " " + shell_word(c.reference_file.string());
  json item{{"name", c.name},
            {"verdict", c.pass()          ? "pass"
                        : c.error.empty() ? "fail"
                                          : "error"},
            {"why", complaint(c)},
            {"repeat", "castray compare " + files + flags + (c.pass() && !whole ? " --html pair.html" : "")}};
  if (std::filesystem::exists(c.image_file)) item["accept"] = "castray accept " + files;
  if (!c.error.empty()) return item;
  item["width"] = c.image.width;
  item["height"] = c.image.height;
  item["encoded"] = c.encoded;
  item["tone"] = to_string(c.display.tone);
  item["exposure"] = c.display.exposure;
  item["measures"] = measures_of(c);
  if (c.pass() && !whole) {
    add_thumbnail(item, c);
    return item;
  }
  if (c.worst) item["worst"] = {c.worst->x0, c.worst->y0, c.worst->x1, c.worst->y1};
  add_pixels(item, c);
  add_heat_map(item, c);
  return item;
}

}  // namespace

std::string html_report(const std::vector<Comparison>& comparisons, const std::string& arguments,
                        const std::string& flags) {
  std::vector<const Comparison*> sorted;
  for (const Comparison& c : comparisons) sorted.push_back(&c);
  std::stable_sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return a->pass() < b->pass(); });
  json data{{"version", CASTRAY_VERSION},
            {"command", "castray compare " + arguments + flags},
            {"items", json::array()}};
  for (const Comparison* c : sorted) data["items"].push_back(item_of(*c, flags, comparisons.size() == 1));
  std::string text = data.dump(-1, ' ', false, json::error_handler_t::replace);
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
  std::string page = compare_page;
  constexpr std::string_view place = "@DATA@";
  return page.replace(page.find(place), place.size(), text);
}

}  // namespace castray::cli
