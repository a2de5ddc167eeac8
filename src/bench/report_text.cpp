#include <fmt/core.h>

#include "bench/ablation.h"
#include "bench/report.h"

namespace castray {

namespace {

std::string seconds_text(std::optional<double> seconds) {
  return seconds ? fmt::format("{:.3g}", *seconds) : std::string("-");
}

std::string heading(const BenchScene& scene) {
  std::string text = fmt::format("{}, {}x{}, against {} (relMSE {:.1e})\n", scene.name, scene.width,
                                 scene.height, scene.reference, scene.reference_noise);
  if (scene.needs_better_references())
    text +=
        "errors are too small beside the references' noise: these need more samples, or shared paths "
        "(--reference-flags)\n";
  if (scene.masked)
    text +=
        fmt::format("errors away from directly seen emitters: {:.1f} % of the pixels\n", 100 * scene.counted);
  return text;
}

std::string points_table(const BenchScene& scene) {
  std::string text = fmt::format("  {:<26} {:>7} {:>9} {:>9} {:>10} {:>10} {:>11}\n", "", "spp", "seconds",
                                 "process", "relMSE", "MSE", "efficiency");
  for (const BenchCurve& curve : scene.curves) {
    if (curve.kind == ContenderKind::ablation) continue;
    for (const BenchPoint& point : curve.points)
      text += fmt::format("  {:<26} {:>7} {:>9.3g} {:>9} {:>10.3g} {:>10.3g} {:>11.4g}\n", curve.name,
                          point.spp, point.seconds, seconds_text(point.process_seconds), point.relmse,
                          point.mse, point.efficiency);
    if (!curve.failure.empty()) text += fmt::format("  {:<26} not here: {}\n", curve.name, curve.failure);
  }
  return text;
}

std::string fits_table(const BenchScene& scene) {
  std::string text = fmt::format("  {:<26} {:>7}", "", "slope");
  for (const double error : target_errors) text += fmt::format(" {:>9}", fmt::format("s to {:.0e}", error));
  text += fmt::format("   at {:.3g} s: {:>7} {:>9} {:>10} {:>7}\n", scene.equal_seconds, "spp", "seconds",
                      "relMSE", "FLIP");
  for (const BenchCurve& curve : scene.curves) {
    if (curve.kind == ContenderKind::ablation || !curve.fit) continue;
    text += fmt::format("  {:<26} {:>7}", curve.name,
                        curve.fit->is_fitted ? fmt::format("{:.2f}", -curve.fit->slope) : "-");
    for (const double error : target_errors)
      text += fmt::format(" {:>9}", seconds_text(curve.fit->seconds_to(error)));
    if (const auto& equal = curve.equal_time)
      text += fmt::format("   {:{}}  {:>7} {:>9.3g} {:>10.3g} {:>7.4f}", "",
                          fmt::format("at {:.3g} s", scene.equal_seconds).size() - 1, equal->spp,
                          equal->seconds, equal->relmse, equal->flip);
    text += "\n";
  }
  return text;
}

std::string ablation_table(const BenchScene& scene) {
  const std::vector<AblationRow> rows = ablation_rows(scene);
  if (rows.empty()) return "";
  std::string text = fmt::format("  {:<26} {:>9} {:>10} {:>11}\n", "one technique off", "x seconds",
                                 "x relMSE", "x efficiency");
  for (const AblationRow& row : rows)
    text += row.failure.empty() ? fmt::format("  {:<26} {:>9.2f} {:>10.2f} {:>11.2f}\n", row.name,
                                              row.seconds, row.relmse, row.efficiency)
                                : fmt::format("  {:<26} not here: {}\n", row.name, row.failure);
  return text;
}

/// A field of a CSV line (RFC 4180).
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string bench_table(const BenchReport& report) {
  std::string text = fmt::format("castray {}, {} threads, {}; medians of {} seeds\n", report.version,
                                 report.threads, report.machine, report.seeds);
  for (const BenchScene& scene : report.scenes) {
    text += "\n" + heading(scene) + points_table(scene) + "\n" + fits_table(scene);
    if (const std::string ablation = ablation_table(scene); !ablation.empty()) text += "\n" + ablation;
  }
  return text;
}

std::string bench_csv(const BenchReport& report) {
  std::string text = "scene,name,kind,spp,seconds,process_seconds,relmse,mse,relmse_everywhere,efficiency\n";
  for (const BenchScene& scene : report.scenes)
    for (const BenchCurve& curve : scene.curves)
      for (const BenchPoint& point : curve.points)
        text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_field(scene.name), csv_field(curve.name),
                            kind_name(curve.kind), point.spp, point.seconds,
                            point.process_seconds ? fmt::format("{}", *point.process_seconds) : "",
                            point.relmse, point.mse, point.relmse_everywhere, point.efficiency);
  return text;
}

}  // namespace castray
