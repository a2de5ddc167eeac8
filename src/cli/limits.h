#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace castray::cli {

/// At most `percent` of the pixels may differ by more than `bound` in a channel.
struct PixelAllowance {
  double percent = 0, bound = 0;
};

/// What a comparison must keep to.
struct Limits {
  std::map<std::string, double> greatest, least;  ///< by metric
  std::optional<PixelAllowance> pixels;
  std::optional<double> ztest;  ///< family-wise false-alarm rate

  bool any() const { return !greatest.empty() || !least.empty() || pixels || ztest; }
  /// These limits, replaced by those of `other` where it has any.
  Limits overridden_by(const Limits& other) const;
};

/// Adds "METRIC=VALUE", as of --max or --min; a later one replaces an earlier one. Each of these throws
/// InputError with `where` in front: the flag or place that the text comes from.
void add_bound(std::map<std::string, double>& bounds, const std::string& where, const std::string& text);
/// "PERCENT:BOUND".
PixelAllowance parse_allowance(const std::string& where, const std::string& text);
double checked_rate(const std::string& where, double rate);

/// A limits file: those of all images, and those of some by name, which replace the former one by one.
struct LimitsFile {
  Limits all;
  std::map<std::string, Limits> by_name;

  Limits of(const std::string& name) const;
};
LimitsFile read_limits(const std::filesystem::path& file);

}  // namespace castray::cli
