#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "castray/error.h"
#include "cli/commands.h"
#include "cli/compare_report.h"
#include "cli/display_flags.h"
#include "cli/image_folder.h"
#include "cli/shell_word.h"
#include "core/files.h"
#include "core/nearest.h"
#include "core/text.h"

namespace castray::cli {

namespace {

namespace fs = std::filesystem;

struct Compare {
  fs::path image, reference;
  std::vector<std::string> greatest, least;
  std::string allowance;
  std::optional<double> ztest;
  DisplayFlags flags;
  std::string layer;
  fs::path limits_file, json, junit, html, heat_map_file;

  int run(const CommonFlags& common) const {
    const LimitsFile limits = all_limits();
    const Viewing viewing{flags.display(), !flags.tone.empty(), layer};
    if (!common.quiet) warn_of_darkening(viewing.display.tone);
    const bool folders = fs::is_directory(image);
    check_inputs(folders);
    check_outputs(folders);
    const std::vector<Comparison> comparisons =
        folders ? compare_folders(limits, viewing, common.quiet) : compare_one(limits, viewing);
    write_reports(comparisons, folders, common.verbose);
    if (std::any_of(comparisons.begin(), comparisons.end(), [](const auto& c) { return !c.error.empty(); }))
      return 2;
    return std::all_of(comparisons.begin(), comparisons.end(), [](const auto& c) { return c.pass(); }) ? 0
                                                                                                       : 1;
  }

 private:
  void check_inputs(bool folders) const {
    if (!fs::exists(image)) throw InputError({image.string()}, "does not exist");
    if (!fs::exists(reference))
      throw InputError({reference.string()}, "does not exist; 'castray accept' makes references of images");
    if (folders != fs::is_directory(reference))
      throw InputError({(folders ? image : reference).string()},
                       "is a folder, and the other is not; give two of a kind");
    if (!layer.empty() && !folders && !has_layers(image) && !has_layers(reference))
      throw InputError("--layer: neither file has layers, which only .exr files have; leave it out");
  }

  void check_outputs(bool folders) const {
    if (folders && !heat_map_file.empty())
      throw InputError("--heatmap: draws one pair of images; use --html for folders");
    check_distinct({json, junit, html, heat_map_file});
    std::error_code ignored;
    for (const fs::path& output : {json, junit, html, heat_map_file})
      for (const fs::path& input : {image, reference, limits_file})
        if (fs::equivalent(output, input, ignored))
          throw InputError({output.string()},
                           "is one of the files to be compared, or their limits; give another name");
    for (const fs::path& output : {json, junit, html})
      if (!output.empty()) check_writable(output);
    if (!heat_map_file.empty()) check_output_image(heat_map_file);
  }

  /// The table goes where no file goes: to stderr if stdout was asked for as a file.
  void write_reports(const std::vector<Comparison>& comparisons, bool folders, bool verbose) const {
    const auto is_stdout = [](const fs::path& file) { return is_standard_output(file); };
    const fs::path outputs[] = {json, junit, html, heat_map_file};
    const bool taken = std::any_of(std::begin(outputs), std::end(outputs), is_stdout);
    fmt::print(taken ? stderr : stdout, "{}", text_report(comparisons, verbose));
    if (folders) print_sizes(taken ? stderr : stdout);
    if (!json.empty()) write_file(json, json_report(comparisons, folders));
    if (!junit.empty()) write_file(junit, junit_report(comparisons));
    if (!html.empty()) write_file(html, html_report(comparisons, arguments(), given_flags()));
    if (!heat_map_file.empty()) write_heat_map(comparisons.front());
  }

  void print_sizes(std::FILE* to) const {
    fmt::print(to, "images {}, references {}\n", size_text(image), size_text(reference));
  }

  LimitsFile all_limits() const {
    LimitsFile file;
    if (!limits_file.empty()) file = read_limits(limits_file);
    Limits given;
    for (const std::string& text : greatest) add_bound(given.greatest, "--max", text);
    for (const std::string& text : least) add_bound(given.least, "--min", text);
    if (!allowance.empty()) given.pixels = parse_allowance("--allow-pixels", allowance);
    if (ztest) given.ztest = checked_rate("--ztest", *ztest);
    file.all = file.all.overridden_by(given);
    for (auto& [name, own] : file.by_name) own = own.overridden_by(given);
    return file;
  }

  std::vector<Comparison> compare_one(const LimitsFile& limits, const Viewing& viewing) const {
    const std::string name = reference.filename().string();
    Comparison comparison = compare_files(name, image, reference, limits.of(name), viewing);
    if (!comparison.error.empty()) throw InputError(comparison.error);
    return {std::move(comparison)};
  }

  std::vector<Comparison> compare_folders(const LimitsFile& limits, const Viewing& viewing,
                                          bool quiet) const {
    std::set<std::string> names = images_below(reference);
    names.merge(images_below(image));
    for (const auto& [name, own] : limits.by_name)
      if (!names.contains(name))
        throw InputError({limits_file.string()}, "has limits of '" + printable(name) +
                                                     "', which is in neither folder" +
                                                     suggestion(name, {names.begin(), names.end()}));
    std::vector<Comparison> comparisons;
    for (const std::string& name : names) {
      comparisons.push_back(compare_files(name, image / name, reference / name, limits.of(name), viewing));
      if (quiet) continue;
      fmt::print(stderr, "compared {} of {}: {}\n", comparisons.size(), names.size(), name);
    }
    return comparisons;
  }

  void write_heat_map(const Comparison& c) const {
    write_image(
        heat_map_file, heat_map(c.image, c.reference), {{ToneCurve::Kind::linear, 1}, 0},
        {{"heat map", "sqrt(mean over channels of (x-r)^2/(r^2+0.01)), logarithmic from 0.001 to 1"}});
  }

  std::string arguments() const { return shell_word(image.string()) + " " + shell_word(reference.string()); }

  /// The flags that shape the verdict, as given.
  std::string given_flags() const {
    std::string text;
    for (const std::string& limit : greatest) text += " --max " + shell_word(limit);
    for (const std::string& limit : least) text += " --min " + shell_word(limit);
    if (!allowance.empty()) text += " --allow-pixels " + shell_word(allowance);
    if (ztest) text += fmt::format(" --ztest {}", *ztest);
    if (!limits_file.empty()) text += " --limits " + shell_word(limits_file.string());
    if (!layer.empty()) text += " --layer " + shell_word(layer);
    if (!flags.tone.empty()) text += " --tone " + shell_word(flags.tone);
    if (flags.exposure != 0) text += fmt::format(" --exposure {}", flags.exposure);
    return text;
  }
};

}  // namespace

Run add_compare(Arguments& arguments, const CommonFlags& common) {
  auto c = std::make_shared<Compare>();
  arguments
      .add_positional(
          "IMAGE", c->image,
          "an image (.exr .pfm .hdr .film .png .ppm .jpg .tga .bmp .gif .psd) or a folder of them")
      .required();
  arguments.add_positional("REFERENCE", c->reference, "what it should look like").required();
  arguments.add(
      "--max", c->greatest, "METRIC=VALUE",
      "a limit, repeatable: mse, rmse, relmse, mae, psnr, max_error, bias, ssim, flip, flip_hdr, alpha");
  arguments.add("--min", c->least, "METRIC=VALUE",
                "the same, from below: for psnr and ssim, which grow with likeness");
  arguments.add("--allow-pixels", c->allowance, "PERCENT:BOUND",
                "so many percent of the pixels may differ by more than BOUND");
  arguments.add("--ztest", c->ztest, "ALPHA",
                "films of 'render --replicates' may differ by noise only; ALPHA is the rate of false alarms");
  arguments.add("--limits", c->limits_file, "FILE.json",
                "limits of a folder, as JSON: max, min, allow-pixels, ztest, images");
  arguments.add("--json", c->json, "FILE", "write what was measured");
  arguments.add("--junit", c->junit, "FILE", "write the verdicts as JUnit XML");
  arguments.add("--html", c->html, "FILE", "write one web page to look at");
  arguments.add("--heatmap", c->heat_map_file, "FILE.png", "draw the error, on a fixed logarithmic scale");
  arguments.add("--layer", c->layer, "NAME", layer_help);
  c->flags.add_to(arguments);
  arguments.footer("Exits with 0 within the limits, 1 if not, 2 if an image cannot be compared.");
  return [c, &common] { return c->run(common); };
}

}  // namespace castray::cli
