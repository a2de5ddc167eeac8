#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "castray/image.h"
#include "castray/render.h"
#include "cli/given_flag.h"

namespace castray::cli {

/// What is told about a render, to people (on stderr) and to programs.
struct RenderReport {
  const Scene& scene;
  const RenderOptions& options;
  const std::vector<GivenFlag>& given;
  bool tells_time = false;  ///< images say how long they took
  double load_seconds = 0, total_seconds = 0;
  RenderResult result{};

  void print_scene(bool verbose) const;
  void print_nonfinite() const;
  void print_black() const;  ///< where the image is black though something emits: why
  /// `as_asked`: the render came to the end that was asked for.
  void print_summary(const std::vector<std::filesystem::path>& outputs, bool as_asked) const;

  /// The contents of a --stats file.
  std::string json() const;
  /// What is stored in PNG and EXR files of a film of this render.
  Metadata metadata(const Film& film) const;

 private:
  void print_warnings(bool verbose) const;
  void print_expected_error() const;
  /// Whether some pixel has all the samples that --spp allows.
  bool limited_by_spp() const;
  /// The flags that, besides those `known`, render the same film of the same scene file.
  std::string repeating_flags(const std::string& known, const Film& film) const;
  /// The command that renders one sample again, alone.
  std::string replay(const NonfiniteSample& sample) const;
};

}  // namespace castray::cli
