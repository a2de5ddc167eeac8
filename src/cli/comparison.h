#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "castray/image.h"
#include "castray/metrics.h"
#include "castray/noise_test.h"
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

/// The pixels x0 <= x < x1, y0 <= y < y1 of an image.
struct PixelBlock {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
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
  std::optional<PixelBlock> worst;  ///< where it differs most, if it exceeds --ztest or --max max_error
  std::vector<Check> checks;

  bool pass() const;  ///< compared, and all checks pass
};

/// How files are read and shown.
struct Viewing {
  Display display;
  bool tone_is_given = false;  ///< else encoded files are not held against radiance
  std::string layer;           ///< as of `read_image`
};

/// Compares. What cannot be compared is told in `error`.
Comparison compare_files(const std::string& name, const std::filesystem::path& image,
                         const std::filesystem::path& reference, const Limits& limits,
                         const Viewing& viewing);

}  // namespace castray::cli
