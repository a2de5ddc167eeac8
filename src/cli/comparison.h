#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "castray/image.h"
#include "castray/metrics.h"
#include "castray/noise_test.h"
#include "cli/display_flags.h"
#include "cli/limits.h"

namespace castray::cli {

/// The metrics that limits may name.
const std::vector<std::string_view>& metric_names();

struct Measure {
  std::string name;
  double value = 0;
};

/// One limit, held against what was measured.
struct Check {
  std::string name;   ///< of the metric, or "allow-pixels", "ztest"
  std::string limit;  ///< e.g. "<= 0.01"
  bool pass = true;
  std::string said;  ///< one sentence: what was found and what is allowed
};

/// One image held against its reference.
struct Comparison {
  std::string name;  ///< of the image within its folder
  std::filesystem::path image_file, reference_file;
  Limits limits;

  std::string error;  ///< why the two cannot be compared; then nothing below is set
  Image image, reference;
  bool encoded = false;            ///< both hold stored values in [0,1], else radiance
  Display display;                 ///< how radiance is shown, and was for ssim and flip
  std::vector<std::string> notes;  ///< what no metric or limit looked at
  ErrorMetrics errors;
  std::vector<Measure> measures;
  std::optional<double> percent_beyond;
  std::optional<NoiseTest> noise;
  std::vector<Check> checks;

  bool pass() const;  ///< compared, and all checks pass
};

/// Compares. What cannot be compared is told in `error`. `layer`: as of `read_image`.
Comparison compare_files(const std::string& name, const std::filesystem::path& image,
                         const std::filesystem::path& reference, const Limits& limits,
                         const DisplayFlags& flags, const std::string& layer = "");

}  // namespace castray::cli
