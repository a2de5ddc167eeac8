#include "cli/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "castray/error.h"

namespace castray::cli {

namespace {

/// Encoded files stay as they are, since what they clipped is lost: against them radiance is encoded too.
void load(Comparison& c, const DisplayFlags& flags) {
  c.display = flags.display();
  ImageFile image = read_image(c.image_file), reference = read_image(c.reference_file);
  if (image.encoded != reference.encoded) {
    const auto& of_8_bits = image.encoded ? c.image_file : c.reference_file;
    if (flags.tone.empty())
      throw InputError(
          {of_8_bits.string()},
          "holds encoded values and the other image linear radiance; say with --tone srgb, linear or "
          "gamma:G how it was encoded, or compare two files of one kind");
    ImageFile& radiance = image.encoded ? reference : image;
    if (count_nonfinite(radiance.image) == 0) radiance.image = displayed(radiance.image, c.display);
    image.encoded = true;
  }
  c.image = std::move(image.image);
  c.reference = std::move(reference.image);
  c.encoded = image.encoded;
}

void measure(Comparison& c) {
  c.errors = measure_errors(c.image, c.reference, c.encoded ? 1 : greatest_component(c.reference));
  for (const auto& [name, value] : c.errors.named()) c.measures.push_back({name, value});
  const Image shown = c.encoded ? c.image : displayed(c.image, c.display);
  const Image shown_reference = c.encoded ? c.reference : displayed(c.reference, c.display);
  c.measures.push_back({"ssim", ssim(shown, shown_reference)});
  c.measures.push_back({"flip", flip(shown, shown_reference)});
  if (!c.encoded) c.measures.push_back({"flip_hdr", flip_hdr(c.image, c.reference)});
  if (c.limits.pixels) c.percent_beyond = percent_beyond(c.image, c.reference, c.limits.pixels->bound);
  if (!c.limits.ztest) return;
  const bool films = is_film_format(c.image_file) && is_film_format(c.reference_file);
  c.noise = films ? test_noise(read_film(c.image_file), read_film(c.reference_file), *c.limits.ztest)
                  : test_noise(read_image(c.image_file), read_image(c.reference_file), *c.limits.ztest);
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
}

void check_noise(Comparison& c) {
  const NoiseTest& test = *c.noise;
  constexpr const char* channels[] = {"red", "green", "blue"};
  std::string said =
      fmt::format("noise explains the difference with p = {:.3g} ({} {}tests), allowed at least {:.3g}",
                  test.p, test.tests, test.paired ? "paired " : "", test.alpha);
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
  static const std::vector<std::string_view> names{"mse",       "rmse", "relmse", "mae",  "psnr",
                                                   "max_error", "bias", "ssim",   "flip", "flip_hdr"};
  return names;
}

bool Comparison::pass() const {
  return error.empty() && std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.pass; });
}

Comparison compare_files(const std::string& name, const std::filesystem::path& image,
                         const std::filesystem::path& reference, const Limits& limits,
                         const DisplayFlags& flags) {
  Comparison c;
  c.name = name;
  c.image_file = image;
  c.reference_file = reference;
  c.limits = limits;
  try {
    load(c, flags);
  } catch (const InputError& error) {
    c.error = error.what();
    return c;
  }
  try {
    measure(c);
    check(c);
  } catch (const InputError& error) {
    c.error = fmt::format("{} against {}: {}", image.string(), reference.string(), error.what());
  }
  return c;
}

}  // namespace castray::cli
