#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "castray/error.h"
#include "castray/metrics.h"
#include "cli/commands.h"
#include "cli/display_flags.h"
#include "core/files.h"
#include "core/nearest.h"

namespace castray::cli {

namespace {

using json = nlohmann::ordered_json;

struct Limit {
  std::string metric;
  double greatest = 0;
};

/// "metric=value".
Limit parse_limit(const std::string& text) {
  const std::vector<std::pair<std::string, double>> known = ErrorMetrics{}.named();
  const std::string name = text.substr(0, text.find('='));
  if (std::none_of(known.begin(), known.end(), [&](const auto& metric) { return metric.first == name; })) {
    std::vector<std::string_view> names;
    for (const auto& metric : known) names.push_back(metric.first);
    throw InputError("--max: there is no metric '" + name + "'" + suggestion(name, names));
  }
  Limit limit{name, 0};
  const char* first = text.data() + std::min(name.size() + 1, text.size());
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, limit.greatest);
  if (first == last || error != std::errc() || end != last || std::isnan(limit.greatest))
    throw InputError("--max " + text + ": give METRIC=VALUE, as in --max " + name + "=0.01");
  return limit;
}

struct Pair {
  Image image, reference;
  bool encoded = false;  ///< both hold stored values in [0,1], else radiance
};

/// Encoded files stay as they are, since what they clipped is lost: against them radiance is encoded too.
Pair load_pair(const std::filesystem::path& image_file, const std::filesystem::path& reference_file,
               const DisplayFlags& flags) {
  ImageFile image = read_image(image_file), reference = read_image(reference_file);
  if (image.encoded != reference.encoded) {
    const auto& of_8_bits = image.encoded ? image_file : reference_file;
    if (flags.tone.empty())
      throw InputError(
          {of_8_bits.string()},
          "holds encoded values and the other image linear radiance; say with --tone srgb, linear or "
          "gamma:G how it was encoded, or compare two files of one kind");
    ImageFile& radiance = image.encoded ? reference : image;
    if (count_nonfinite(radiance.image) == 0) radiance.image = displayed(radiance.image, flags.display());
    image.encoded = true;
  }
  return {std::move(image.image), std::move(reference.image), image.encoded};
}

struct Compare {
  std::filesystem::path image, reference, json_file, heat_map_file;
  std::vector<std::string> limit_texts;
  DisplayFlags flags;

  int run() const {
    std::vector<Limit> limits;
    for (const std::string& text : limit_texts) limits.push_back(parse_limit(text));
    flags.display();
    if (!json_file.empty()) check_writable(json_file);
    if (!heat_map_file.empty()) check_output_image(heat_map_file);
    const Pair pair = load_pair(image, reference, flags);
    const ErrorMetrics metrics = measure(pair);
    const bool pass = report(pair, metrics, limits);
    if (!json_file.empty()) write_file(json_file, to_json(pair, metrics, limits, pass).dump(2) + "\n");
    if (!heat_map_file.empty())
      write_image(
          heat_map_file, heat_map(pair.image, pair.reference), {{ToneCurve::Kind::linear, 1}, 0},
          {{"heat map", "sqrt(mean over channels of (x-r)^2/(r^2+0.01)), logarithmic from 0.001 to 1"}});
    return pass ? 0 : 1;
  }

 private:
  ErrorMetrics measure(const Pair& pair) const {
    try {
      return measure_errors(pair.image, pair.reference,
                            pair.encoded ? 1 : greatest_component(pair.reference));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{} against {}: {}", image.string(), reference.string(), error.what()));
    }
  }

  static double value_of(const ErrorMetrics& metrics, const std::string& name) {
    for (const auto& [metric, value] : metrics.named())
      if (metric == name) return value;
    return std::nan("");
  }

  /// Prints the table; whether all limits hold.
  bool report(const Pair& pair, const ErrorMetrics& metrics, const std::vector<Limit>& limits) const {
    fmt::print("{} against {}, {}x{}, {}\n", image.string(), reference.string(), pair.image.width,
               pair.image.height, pair.encoded ? "encoded values" : "linear radiance");
    bool pass = true;
    for (const auto& [name, value] : metrics.named()) {
      fmt::print("  {:<10}{:>12.6g}", name, value);
      if (name == "psnr") fmt::print(" dB, peak {:.6g}", metrics.peak);
      if (name == "max_error") fmt::print(" at pixel ({},{})", metrics.max_x, metrics.max_y);
      if (name == "bias")
        fmt::print("  red {:+.6g}, green {:+.6g}, blue {:+.6g}", metrics.bias.x, metrics.bias.y,
                   metrics.bias.z);
      for (const Limit& limit : limits) {
        if (limit.metric != name) continue;
        const bool within = value <= limit.greatest;
        fmt::print("  {} {:.6g}", within ? "within" : "EXCEEDS", limit.greatest);
        pass = pass && within;
      }
      fmt::print("\n");
    }
    if (!limits.empty()) fmt::print("{}\n", pass ? "within the limits" : "NOT within the limits");
    return pass;
  }

  json to_json(const Pair& pair, const ErrorMetrics& metrics, const std::vector<Limit>& limits,
               bool pass) const {
    json values, bounds = json::object();
    for (const auto& [name, value] : metrics.named()) values[name] = value;  // infinity becomes null
    for (const Limit& limit : limits) bounds[limit.metric] = limit.greatest;
    return {{"image", image.string()},
            {"reference", reference.string()},
            {"width", pair.image.width},
            {"height", pair.image.height},
            {"values", pair.encoded ? "encoded" : "radiance"},
            {"metrics", values},
            {"psnr_peak", metrics.peak},
            {"max_error_pixel", {metrics.max_x, metrics.max_y}},
            {"bias_rgb", {metrics.bias.x, metrics.bias.y, metrics.bias.z}},
            {"limits", bounds},
            {"pass", pass}};
  }
};

}  // namespace

Run add_compare(CLI::App& app) {
  auto compare = std::make_shared<Compare>();
  app.add_option("IMAGE", compare->image, "a .ppm, .png, .pfm, .hdr, .exr or .film file")->required();
  app.add_option("REFERENCE", compare->reference, "what it should look like")->required();
  app.add_option("--max", compare->limit_texts,
                 "a limit; may be repeated; metrics: mse, rmse, relmse, mae, psnr, max_error, bias")
      ->type_name("METRIC=VALUE")
      ->allow_extra_args(false);
  app.add_option("--json", compare->json_file, "write the metrics here")->type_name("FILE");
  app.add_option("--heatmap", compare->heat_map_file, "draw the error here, on a fixed logarithmic scale")
      ->type_name("FILE.png");
  compare->flags.add_to(app);
  app.footer("Exits with 0 within the limits, 1 if not, 2 if the images cannot be compared.");
  return [compare] { return compare->run(); };
}

}  // namespace castray::cli
