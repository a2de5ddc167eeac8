#include "cli/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "castray/error.h"
#include "cli/comparison.h"
#include "core/files.h"
#include "core/nearest.h"
#include "core/text.h"

namespace castray::cli {

namespace {

using nlohmann::json;

void check_metric(const std::string& where, const std::string& name) {
  const auto& known = metric_names();
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw InputError(where + ": there is no metric '" + printable(name) + "'" + suggestion(name, known));
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || std::isnan(value))
    return std::nullopt;
  return value;
}

double number_of(const std::string& where, const json& value) {
  if (!value.is_number()) throw InputError(where + ": must be a number");
  return value.get<double>();
}

std::map<std::string, double> read_bounds(const std::string& where, const json& object) {
  std::map<std::string, double> bounds;
  if (!object.is_object()) throw InputError(where + ": must be an object of metrics and numbers");
  for (const auto& [name, value] : object.items()) {
    check_metric(where, name);
    bounds[name] = number_of(where + "." + name, value);
  }
  return bounds;
}

Limits read_object(const std::string& where, const json& object, bool top) {
  Limits limits;
  if (!object.is_object()) throw InputError(where + ": must be an object");
  for (const auto& [key, value] : object.items()) {
    const std::string at = where + ": " + printable(key);
    if (key == "max")
      limits.greatest = read_bounds(at, value);
    else if (key == "min")
      limits.least = read_bounds(at, value);
    else if (key == "ztest")
      limits.ztest = checked_rate(at, number_of(at, value));
    else if (key == "allow-pixels" && value.is_string())
      limits.pixels = parse_allowance(at, value.get<std::string>());
    else if (key == "allow-pixels")
      throw InputError(at + ": must be a text PERCENT:BOUND");
    else if (!(top && key == "images"))
      throw InputError(where + ": unknown key '" + printable(key) + "'" +
                       suggestion(key, {"max", "min", "ztest", "allow-pixels", "images"}));
  }
  return limits;
}

}  // namespace

Limits Limits::overridden_by(const Limits& other) const {
  Limits result = *this;
  for (const auto& [name, value] : other.greatest) result.greatest[name] = value;
  for (const auto& [name, value] : other.least) result.least[name] = value;
  if (other.pixels) result.pixels = other.pixels;
  if (other.ztest) result.ztest = other.ztest;
  return result;
}

void add_bound(std::map<std::string, double>& bounds, const std::string& where, const std::string& text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const std::string name = text.substr(0, equals);
  check_metric(where, name);
  const std::optional<double> value =
      number(std::string_view(text).substr(std::min(equals + 1, text.size())));
  if (!value)
    throw InputError(where + " " + printable(text) + ": give METRIC=VALUE, as in " + name + "=0.01");
  bounds[name] = *value;
}

PixelAllowance parse_allowance(const std::string& where, const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const auto percent = number(std::string_view(text).substr(0, colon));
  const auto bound = number(std::string_view(text).substr(std::min(colon + 1, text.size())));
  if (!percent || !bound || *percent < 0 || *percent > 100 || *bound < 0)
    throw InputError(where + " " + printable(text) + ": give PERCENT:BOUND, as in 0.1:0.05");
  return {*percent, *bound};
}

double checked_rate(const std::string& where, double rate) {
  if (rate > 0 && rate < 1) return rate;
  throw InputError(fmt::format("{}: {} is not a false-alarm rate between 0 and 1, as in 0.01", where, rate));
}

LimitsFile read_limits(const std::filesystem::path& file) {
  json document;
  try {
    document = json::parse(read_file(file), nullptr, true, true);
  } catch (const json::exception& error) {
    throw InputError({file.string()}, printable(error.what()));
  }
  LimitsFile limits{read_object(file.string(), document, true), {}};
  if (const auto images = document.find("images"); images != document.end())
    for (const auto& [name, object] : images->items())
      limits.by_name[name] = read_object(file.string() + ": " + printable(name), object, false);
  return limits;
}

Limits LimitsFile::of(const std::string& name) const {
  const auto own = by_name.find(name);
  return own == by_name.end() ? all : all.overridden_by(own->second);
}

}  // namespace castray::cli
