#include "cli/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace castray::cli {

std::string metric_detail(const ErrorMetrics& errors, const std::string& metric) {
  const Vec3d& bias = errors.bias;
  if (metric == "psnr") return fmt::format("dB, peak {:.6g}", errors.peak);
  if (metric == "max_error") return fmt::format("at pixel ({},{})", errors.max_x, errors.max_y);
  if (metric == "bias")
    return fmt::format("red {:+.4g}, green {:+.4g}, blue {:+.4g}", bias.x, bias.y, bias.z);
  return "";
}

std::string complaint(const Comparison& c) {
  std::string text = c.error;
  for (const Check& check : c.checks)
    if (!check.pass) text += (text.empty() ? "" : "; ") + check.said;
  return text;
}

namespace {

using json = nlohmann::ordered_json;

const Check* check_of(const Comparison& c, const std::string& name) {
  const auto found =
      std::find_if(c.checks.begin(), c.checks.end(), [&](const Check& k) { return k.name == name; });
  return found == c.checks.end() ? nullptr : &*found;
}

constexpr const char* not_judged =
    "no limits were given, so nothing was judged; give --max METRIC=VALUE, --ztest ALPHA or --limits FILE\n";

/// A line each.
std::string notes_of(const Comparison& c, const char* before) {
  std::string text;
  for (const std::string& note : c.notes) text += before + note + "\n";
  return text;
}

std::string table(const Comparison& c) {
  std::string text =
      fmt::format("{} against {}, {}x{}, {}\n", c.image_file.string(), c.reference_file.string(),
                  c.image.width, c.image.height, c.encoded ? "encoded values" : "linear radiance");
  for (const Measure& m : c.measures) {
    const std::string detail = metric_detail(c.errors, m.name);
    text += fmt::format("  {:<10}{:>12.6g}{}", m.name, m.value, detail.empty() ? "" : " " + detail);
    if (const Check* check = check_of(c, m.name))
      text += fmt::format("  {} {}", check->pass ? "within" : "EXCEEDS", check->limit);
    text += "\n";
  }
  for (const Check& check : c.checks)
    if (check.name == "allow-pixels" || check.name == "ztest")
      text += fmt::format("  {:<12}  {}: {}\n", check.name, check.pass ? "within" : "EXCEEDS", check.said);
  text += notes_of(c, "  note: ");
  if (!c.checks.empty()) text += c.pass() ? "within the limits\n" : "NOT within the limits\n";
  return text;
}

bool judged(const std::vector<Comparison>& comparisons) {
  return std::any_of(comparisons.begin(), comparisons.end(),
                     [](const Comparison& c) { return !c.checks.empty(); });
}

json to_json(const Comparison& c) {
  json object{{"name", c.name}, {"image", c.image_file.string()}, {"reference", c.reference_file.string()}};
  if (!c.error.empty()) {
    object["error"] = c.error;
    object["pass"] = false;
    return object;
  }
  const ErrorMetrics& e = c.errors;
  object["width"] = c.image.width;
  object["height"] = c.image.height;
  object["values"] = c.encoded ? "encoded" : "radiance";
  for (const Measure& m : c.measures) object["metrics"][m.name] = m.value;  // infinity becomes null
  object["psnr_peak"] = e.peak;
  object["max_error_pixel"] = {e.max_x, e.max_y};
  object["bias_rgb"] = {e.bias.x, e.bias.y, e.bias.z};
  object["limits"] = c.limits.greatest;
  if (!c.limits.least.empty()) object["limits_min"] = c.limits.least;
  if (c.percent_beyond)
    object["allow_pixels"] = {{"percent", c.limits.pixels->percent},
                              {"bound", c.limits.pixels->bound},
                              {"found_percent", *c.percent_beyond}};
  if (c.noise)
    object["ztest"] = {{"alpha", c.noise->alpha},
                       {"tests", c.noise->tests},
                       {"paired", c.noise->paired},
                       {"p", c.noise->p},
                       {"block", {c.noise->x0, c.noise->y0, c.noise->x1, c.noise->y1}},
                       {"channel", c.noise->channel},
                       {"t", c.noise->t},
                       {"rms_t", c.noise->rms_t},
                       {"means", {c.noise->mean, c.noise->mean_reference}},
                       {"pass", !c.noise->differs()}};
  if (!c.notes.empty()) object["notes"] = c.notes;
  object["judged"] = !c.checks.empty();
  object["pass"] = c.pass();
  return object;
}

/// `text` with U+FFFD for bytes that are not UTF-8, as names of files may have.
std::string utf8(const std::string& text) {
  return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

std::string xml(const std::string& text) {
  std::string escaped;
  for (const char c : utf8(text)) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
  }
  return escaped;
}

}  // namespace

std::string text_report(const std::vector<Comparison>& comparisons, bool all_tables) {
  if (comparisons.size() == 1 && comparisons.front().error.empty())
    return table(comparisons.front()) + (judged(comparisons) ? "" : not_judged);
  std::string text;
  if (all_tables)
    for (const Comparison& c : comparisons)
      if (c.error.empty()) text += table(c) + "\n";
  std::size_t passed = 0;
  for (const Comparison& c : comparisons) {
    passed += c.pass();
    const char* verdict = !c.error.empty() ? "ERROR" : c.checks.empty() ? "-" : c.pass() ? "pass" : "FAIL";
    text += fmt::format("{:<6}{}", verdict, c.name);
    if (c.error.empty())
      text += fmt::format("  relmse {:.3g}, flip {:.3g}", c.errors.relmse, c.measures[8].value);
    const std::string why = complaint(c);
    text += (why.empty() ? "" : "  " + why) + "\n" + notes_of(c, "      note: ");
  }
  if (!judged(comparisons)) return text + not_judged;
  return text + fmt::format("{} of {} images pass\n", passed, comparisons.size());
}

std::string json_report(const std::vector<Comparison>& comparisons, bool folders) {
  json document;
  if (!folders) {
    document = to_json(comparisons.front());
  } else {
    document["pass"] =
        std::all_of(comparisons.begin(), comparisons.end(), [](const auto& c) { return c.pass(); });
    document["comparisons"] = json::array();
    for (const Comparison& c : comparisons) document["comparisons"].push_back(to_json(c));
  }
  return document.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string junit_report(const std::vector<Comparison>& comparisons) {
  const auto errors =
      std::count_if(comparisons.begin(), comparisons.end(), [](auto& c) { return !c.error.empty(); });
  const auto passed = std::count_if(comparisons.begin(), comparisons.end(), [](auto& c) { return c.pass(); });
  const auto total = static_cast<std::ptrdiff_t>(comparisons.size());
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuite name=\"castray compare\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"0\">\n",
      total, total - passed - errors, errors);
  for (const Comparison& c : comparisons) {
    text += fmt::format("  <testcase classname=\"castray.compare\" name=\"{}\"", xml(c.name));
    if (c.pass()) {
      text += "/>\n";
      continue;
    }
    const char* kind = c.error.empty() ? "failure" : "error";
    text += fmt::format(">\n    <{} type=\"{}\" message=\"{}\">{}</{}>\n  </testcase>\n", kind,
                        c.error.empty() ? "beyond the limits" : "cannot be compared", xml(complaint(c)),
                        xml(c.error.empty() ? table(c) : c.error), kind);
  }
  return text + "</testsuite>\n";
}

}  // namespace castray::cli
