#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/ablation.h"
#include "bench/crop.h"
#include "bench/plot.h"
#include "bench/report.h"
#include "core/base64.h"

namespace castray {

namespace {

constexpr const char* page_style = R"(
:root{color-scheme:light dark;--ink:#222;--soft:#666;--line:#ddd;--paper:#fff;--bar:#0072b2}
@media(prefers-color-scheme:dark){:root{--ink:#ddd;--soft:#999;--line:#3a3e44;--paper:#17191c;--bar:#4db2f0}}
body{font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--paper);max-width:64rem;margin:auto;padding:1rem}
h1{font-size:1.6rem}h2{margin-top:3rem;border-top:1px solid var(--line);padding-top:1rem}
.soft,figcaption{color:var(--soft);font-size:.85rem}code{font-size:.85em;overflow-wrap:anywhere}
.scroll{overflow-x:auto}th:first-child,td:first-child{position:sticky;left:0;background:var(--paper)}table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.9rem}
th,td{padding:.25rem .7rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th:first-child,td:first-child{text-align:left}svg{width:100%;max-width:46rem;height:auto}
.pictures{display:grid;grid-template-columns:repeat(auto-fill,minmax(15rem,1fr));gap:1.5rem 1rem}
figure{margin:0;max-width:24rem}figcaption{margin-top:.4rem}figure img{width:100%;display:block;outline:1px solid var(--line)}figure .part{margin-top:.4rem;image-rendering:pixelated}
.whole{position:relative}.whole span{position:absolute;box-sizing:border-box;border:2px solid #ff3bd0;outline:1px solid #000}
@media(max-width:40rem){body{padding:.6rem}h1{font-size:1.3rem}h2{margin-top:2rem}th,td{padding:.25rem .45rem}figure{max-width:none}}
.bar{display:inline-block;height:.7em;background:var(--bar);vertical-align:middle}
)";

/// A PNG with sRGB's curve, as an address that holds it.
std::string data_address(const Image& image) { return "data:image/png;base64," + base64(encode_png(image)); }

std::vector<PlotSeries> series_of(const BenchScene& scene) {
  std::vector<PlotSeries> all;
  for (const BenchCurve& curve : scene.curves) {
    if (curve.kind == ContenderKind::ablation) continue;
    PlotSeries series{curve.name, {}, curve.fit};
    for (const BenchPoint& point : curve.points) series.points.push_back({point.seconds, point.relmse});
    all.push_back(std::move(series));
  }
  return all;
}

std::string cells(const char* tag, const std::vector<std::string>& texts) {
  std::string row = "<tr>";
  for (const std::string& text : texts) row += fmt::format("<{0}>{1}</{0}>", tag, text);
  return row + "</tr>\n";
}

std::string number(std::optional<double> value) { return value ? fmt::format("{:.3g}", *value) : "\u2013"; }

std::string points_table(const BenchScene& scene) {
  std::string text =
      "<div class=\"scroll\"><table>\n" + cells("th", {"", "spp", "seconds", "whole process", "relMSE", "MSE",
                                                       "relMSE everywhere", "1/(relMSE \u00d7 s)"});
  for (const BenchCurve& curve : scene.curves) {
    if (curve.kind == ContenderKind::ablation) continue;
    for (const BenchPoint& point : curve.points)
      text += cells("td", {escape_markup(curve.name), fmt::format("{}", point.spp), number(point.seconds),
                           number(point.process_seconds), number(point.relmse), number(point.mse),
                           number(point.relmse_everywhere), fmt::format("{:.4g}", point.efficiency)});
  }
  return text + "</table></div>\n";
}

std::string slope_text(const PowerLaw& fit) {
  if (!fit.is_fitted) return "\u2013";
  return fmt::format("{}{:.2f}", fit.slope > 0 ? "\u2212" : "", std::abs(fit.slope));
}

std::string fits_table(const BenchScene& scene) {
  std::vector<std::string> head{"", "slope"};
  for (const double error : target_errors) head.push_back(fmt::format("seconds to {:.0e}", error));
  std::string text = "<div class=\"scroll\"><table>\n" + cells("th", head);
  for (const BenchCurve& curve : scene.curves) {
    if (curve.kind == ContenderKind::ablation || !curve.fit) continue;
    std::vector<std::string> row{escape_markup(curve.name), slope_text(*curve.fit)};
    for (const double error : target_errors) row.push_back(number(curve.fit->seconds_to(error)));
    text += cells("td", row);
  }
  return text +
         "</table></div>\n<p class=\"soft\">Slope of log relMSE over log seconds; times from that line. One "
         "budget "
         "has no slope: its times take \u22121.</p>\n";
}

/// The whole image, a frame where it is shown enlarged, and that part.
std::string picture(const Image& image, const Window& crop, const std::string& name,
                    const std::string& numbers) {
  const auto percent = [](int part, int whole) { return 100.0 * part / whole; };
  const std::string frame =
      fmt::format("left:{:.2f}%;top:{:.2f}%;width:{:.2f}%;height:{:.2f}%", percent(crop.x0, image.width),
                  percent(crop.y0, image.height), percent(crop.width(), image.width),
                  percent(crop.height(), image.height));
  return fmt::format(
      "<figure><div class=\"whole\"><img alt=\"{0}\" src=\"{1}\"><span style=\"{4}\"></span></div>"
      "<img class=\"part\" alt=\"{0}, the framed part enlarged\" src=\"{2}\">"
      "<figcaption><b>{0}</b><br>{3}</figcaption></figure>\n",
      escape_markup(name), data_address(image), data_address(cropped(image, crop)), numbers, frame);
}

std::string pictures(const BenchScene& scene) {
  std::string text =
      fmt::format("<h3>Pictures after {:.3g} s</h3>\n<div class=\"pictures\">\n", scene.equal_seconds);
  for (const BenchCurve& curve : scene.curves) {
    if (curve.kind == ContenderKind::ablation || !curve.equal_time) continue;
    const EqualTimeRun& equal = *curve.equal_time;
    text += picture(equal.image, scene.crop, curve.name,
                    fmt::format("{} spp, {:.3g} s, relMSE {:.2e}, FLIP {:.4f}", equal.spp, equal.seconds,
                                equal.relmse, equal.flip));
  }
  text += picture(scene.reference_image, scene.crop, "reference", escape_markup(scene.reference));
  return text + "</div>\n";
}

std::string ablation(const BenchScene& scene) {
  const std::vector<AblationRow> rows = ablation_rows(scene);
  if (rows.empty()) return "";
  std::string text = "<h3>One technique off</h3>\n<div class=\"scroll\"><table>\n" +
                     cells("th", {"", "\u00d7 seconds", "\u00d7 relMSE", "\u00d7 efficiency", "", "flags"});
  for (const AblationRow& row : rows) {
    if (!row.failure.empty()) continue;
    const double width = std::min(row.efficiency, 2.0) * 6;
    text += cells("td", {escape_markup(row.name), fmt::format("{:.2f}", row.seconds),
                         fmt::format("{:.2f}", row.relmse), fmt::format("{:.3g}", row.efficiency),
                         fmt::format("<span class=\"bar\" style=\"width:{:.2f}rem\"></span>", width),
                         "<code>" + escape_markup(row.detail) + "</code>"});
  }
  return text + "</table></div>\n";
}

std::string details(const BenchScene& scene) {
  std::string text = "<details><summary>What was run</summary>\n<ul>\n";
  for (const BenchCurve& curve : scene.curves)
    text += fmt::format("<li>{} ({}): <code>{}</code> {}</li>\n", escape_markup(curve.name),
                        kind_name(curve.kind), escape_markup(curve.detail), escape_markup(curve.failure));
  return text + "</ul></details>\n";
}

std::string section(const BenchScene& scene) {
  std::string text =
      fmt::format("<h2>{}</h2>\n<p class=\"soft\">{}, {}\u00d7{} pixels; reference: {}, relMSE {:.1e}. ",
                  escape_markup(scene.name), escape_markup(scene.file), scene.width, scene.height,
                  escape_markup(scene.reference), scene.reference_noise);
  if (scene.needs_better_references()) text += "Errors are too small for this reference. ";
  text += scene.masked
              ? fmt::format("Errors are those of the {:.1f} % of the pixels that see no emitter directly.",
                            100 * scene.counted)
              : "Errors are those of all pixels.";
  text += fmt::format(
      "</p>\n<svg viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"error over time\">\n{2}</svg>\n",
      plot_width, plot_height, log_log_plot(scene.name, series_of(scene)));
  return text + points_table(scene) + fits_table(scene) + pictures(scene) + ablation(scene) + details(scene);
}

}  // namespace

std::string bench_html(const BenchReport& report) {
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<title>castray: time against error</title>\n<style>{}{}</style></head><body>\n"
      "<h1>Time against error</h1>\n"
      "<p>castray {}, {} threads, {}; medians of {} seeds. Seconds are of the render alone; relMSE is free "
      "of the "
      "references' noise.</p>\n<p><code>{}</code></p>\n",
      page_style, plot_style(), escape_markup(report.version), report.threads, escape_markup(report.machine),
      report.seeds, escape_markup(report.command));
  for (const BenchScene& scene : report.scenes) text += section(scene);
  return text + "</body></html>\n";
}

std::string bench_svg(const BenchReport& report) {
  const int columns = report.scenes.size() > 1 ? 2 : 1;
  const int rows = (static_cast<int>(report.scenes.size()) + columns - 1) / columns;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
      "<style>{2}.paper{{fill:#fff}}@media(prefers-color-scheme:dark){{.paper{{fill:#17191c}}}}</style>\n"
      "<rect class=\"paper\" width=\"{0}\" height=\"{1}\"/>\n",
      columns * plot_width, rows * plot_height, plot_style());
  for (std::size_t i = 0; i < report.scenes.size(); ++i)
    text +=
        fmt::format("<g transform=\"translate({} {})\">\n{}</g>\n",
                    static_cast<int>(i) % columns * plot_width, static_cast<int>(i) / columns * plot_height,
                    log_log_plot(report.scenes[i].name, series_of(report.scenes[i])));
  return text + "</svg>\n";
}

}  // namespace castray
