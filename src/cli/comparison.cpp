#include "cli/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "castray/denoise.h"
#include "castray/error.h"

namespace castray::cli {

namespace {

struct Files {
  ImageFile image, reference;
};

/// Encoded files stay as they are, since what they clipped is lost: against them radiance is encoded too.
void encode_alike(const Comparison& c, Files& files, bool tone_is_given) {
  ImageFile &image = files.image, &reference = files.reference;
  if (image.encoded == reference.encoded) return;
  if (!tone_is_given)
    throw InputError(
        {(image.encoded ? c.image_file : c.reference_file).string()},
        "holds encoded values and the other image linear radiance; say with --tone srgb, linear or "
        "gamma:G how it was encoded, or compare two files of one kind");
  ImageFile& radiance = image.encoded ? reference : image;
  if (count_nonfinite(radiance.image) == 0) radiance.image = displayed(radiance.image, c.display);
  radiance.encoded = true;
}

void note_left_out(Comparison& c, const std::filesystem::path& file, const ImageFile& read) {
  if (read.left_out.empty()) return;
  c.notes.push_back(fmt::format("{}: not compared: {}", file.string(), fmt::join(read.left_out, ", ")));
}

Files load(Comparison& c, const Viewing& viewing) {
  c.display = viewing.display;
  Files files{read_image(c.image_file, viewing.layer), read_image(c.reference_file, viewing.layer)};
  note_left_out(c, c.image_file, files.image);
  note_left_out(c, c.reference_file, files.reference);
  encode_alike(c, files, viewing.tone_is_given);
  c.encoded = files.image.encoded;
  return files;
}

/// The greatest difference of two alphas of one size, which are 1 where a file has none.
double alpha_difference(const ImageFile& image, const ImageFile& reference) {
  const auto at = [](const ImageFile& file, std::size_t i) { return file.alpha.empty() ? 1 : file.alpha[i]; };
  double greatest = 0;
  for (std::size_t i = 0; i < std::max(image.alpha.size(), reference.alpha.size()); ++i)
    greatest = std::max<double>(greatest, std::abs(at(image, i) - at(reference, i)));
  return greatest;
}

void measure_alpha(Comparison& c, const Files& files) {
  const bool is_limited = c.limits.greatest.contains("alpha") || c.limits.least.contains("alpha");
  if (files.image.alpha.empty() && files.reference.alpha.empty() && !is_limited) return;
  const double difference = alpha_difference(files.image, files.reference);
  c.measures.push_back({"alpha", difference});
  if (difference > 0 && !is_limited)
    c.notes.push_back("alpha differs, and no limit judges it; give --max alpha=VALUE");
}

void measure_noise(Comparison& c, const Files& files) {
  if (!c.limits.ztest) return;
  refuse_denoised(c.image_file, files.image.metadata, "no z-test can judge it");
  refuse_denoised(c.reference_file, files.reference.metadata, "no z-test can judge by it");
  int left = 0, top = 0;  // the test tells places in the full image
  if (is_film_format(c.image_file) && is_film_format(c.reference_file)) {
    const Film film = read_film(c.image_file);
    c.noise = test_noise(film, read_film(c.reference_file), *c.limits.ztest);
    left = film.window().x0, top = film.window().y0;
  } else {
    c.noise = test_noise(files.image, files.reference, *c.limits.ztest);
  }
  if (const NoiseTest& test = *c.noise; test.differs())
    c.worst = PixelBlock{test.x0 - left, test.y0 - top, test.x1 - left, test.y1 - top};
}

void measure(Comparison& c, const Files& files) {
  c.image = files.image.image;
  c.reference = files.reference.image;
  c.errors = measure_errors(c.image, c.reference, c.encoded ? 1 : greatest_component(c.reference));
  for (const auto& [name, value] : c.errors.named()) c.measures.push_back({name, value});
  const Image shown = c.encoded ? c.image : displayed(c.image, c.display);
  const Image shown_reference = c.encoded ? c.reference : displayed(c.reference, c.display);
  c.measures.push_back({"ssim", ssim(shown, shown_reference)});
  c.measures.push_back({"flip", flip(shown, shown_reference)});
  if (!c.encoded) c.measures.push_back({"flip_hdr", flip_hdr(c.image, c.reference)});
  measure_alpha(c, files);
  if (c.limits.pixels) c.percent_beyond = percent_beyond(c.image, c.reference, c.limits.pixels->bound);
  measure_noise(c, files);
}

void check_bound(Comparison& c, const std::string& name, double bound, bool greatest) {
  const auto found =
      std::find_if(c.measures.begin(), c.measures.end(), [&](const Measure& m) { return m.name == name; });
  if (found == c.measures.end())
    throw InputError("there is no " + name + " of encoded images; it needs linear radiance in both files");
  const bool pass = greatest ? found->value <= bound : found->value >= bound;
  const char* relation = greatest ? "at most" : "at least";
  c.checks.push_back({name, fmt::format("{} {:.6g}", greatest ? "<=" : ">=", bound), pass,
                      fmt::format("{} is {:.6g}, allowed {} {:.6g}", name, found->value, relation, bound)});
  if (name == "max_error" && !pass && !c.worst)
    c.worst = PixelBlock{c.errors.max_x, c.errors.max_y, c.errors.max_x + 1, c.errors.max_y + 1};
}

void check_noise(Comparison& c) {
  const NoiseTest& test = *c.noise;
  constexpr const char* channels[] = {"red", "green", "blue"};
  std::string said = fmt::format(
      "{}: the chance that noise alone differs as much somewhere is {}{:.3g} ({} {}tests), allowed from "
      "{:.3g} on",
      test.differs() ? "differs" : "within the noise", test.differs() ? "below " : "", test.p, test.tests,
      test.paired ? "paired " : "", test.alpha);
  if (test.differs())
    said += fmt::format("; most in {}, pixels {},{} to {},{}: {:.6g} against {:.6g}, {:.1f} standard errors",
                        channels[test.channel], test.x0, test.y0, test.x1 - 1, test.y1 - 1, test.mean,
                        test.mean_reference, test.t);
  c.checks.push_back({"ztest", fmt::format("p >= {:.3g}", test.alpha), !test.differs(), said});
}

void check(Comparison& c) {
  for (const auto& [name, bound] : c.limits.greatest) check_bound(c, name, bound, true);
  for (const auto& [name, bound] : c.limits.least) check_bound(c, name, bound, false);
  if (c.percent_beyond) {
    const PixelAllowance& allowed = *c.limits.pixels;
    c.checks.push_back(
        {"allow-pixels", fmt::format("<= {:.6g} %", allowed.percent), *c.percent_beyond <= allowed.percent,
         fmt::format("{:.6g} % of the pixels differ by more than {:.6g}, allowed at most {:.6g} %",
                     *c.percent_beyond, allowed.bound, allowed.percent)});
  }
  if (c.noise) check_noise(c);
}

}  // namespace

const std::vector<std::string_view>& metric_names() {
  static const std::vector<std::string_view> names{"mse",  "rmse", "relmse", "mae",      "psnr", "max_error",
                                                   "bias", "ssim", "flip",   "flip_hdr", "alpha"};
  return names;
}

bool Comparison::pass() const {
  return error.empty() && std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.pass; });
}

Comparison compare_files(const std::string& name, const std::filesystem::path& image,
                         const std::filesystem::path& reference, const Limits& limits,
                         const Viewing& viewing) {
  Comparison c;
  c.name = name;
  c.image_file = image;
  c.reference_file = reference;
  c.limits = limits;
  Files files;
  try {
    files = load(c, viewing);
  } catch (const InputError& error) {
    c.error = error.what();
    return c;
  }
  try {
    measure(c, files);
    check(c);
  } catch (const InputError& error) {
    c.error = fmt::format("{} against {}: {}", image.string(), reference.string(), error.what());
  }
  return c;
}

}  // namespace castray::cli
