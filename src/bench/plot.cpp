#include "bench/plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace castray {

namespace {

constexpr double left = 56, top = 36, bottom = 46;
constexpr int colours = 8;

/// One logarithmic axis: values low..high, both powers of ten, map to from..to.
struct Axis {
  double low = -1, high = 0;  ///< log10
  double from = 0, to = 1;

  double at(double value) const { return from + (std::log10(value) - low) / (high - low) * (to - from); }
};

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = 0;

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

bool shown(const TimeAndError& point) { return point.seconds > 0 && point.error > 0; }

/// From half a decade to half a decade, with some air at both ends.
Axis make_axis(Range range, double from, double to) {
  if (!(range.high > 0)) range = {0.1, 1};
  Axis axis{std::floor(2 * std::log10(range.low) - 0.2) / 2, std::ceil(2 * std::log10(range.high) + 0.2) / 2,
            from, to};
  if (axis.high - axis.low < 1) axis.high = axis.low + 1;
  return axis;
}

/// Each decade's grid line and label, and ticks at 2..9.
template <class Line, class Label>
std::string ticks(const Axis& axis, Line line, Label label) {
  std::string text;
  for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade) {
    for (int digit = 1; digit < 10; ++digit) {
      const double value = digit * std::pow(10.0, decade);
      if (std::log10(value) < axis.low - 1e-9 || std::log10(value) > axis.high + 1e-9) continue;
      text += line(axis.at(value), digit == 1);
      if (digit == 1) text += label(axis.at(value), decade);
    }
  }
  return text;
}

std::string power_of_ten(int decade) {
  if (decade >= -1 && decade <= 2) return fmt::format("{:g}", std::pow(10.0, decade));
  return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}{}</tspan>", decade < 0 ? "\u2212" : "",
                     std::abs(decade));
}

std::string grid(const Axis& x, const Axis& y) {
  const auto grid_line = [](double x1, double y1, double x2, double y2, bool major) {
    return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n",
                       major ? "grid" : "tick", x1, y1, x2, y2);
  };
  std::string text = ticks(
      x, [&](double at, bool major) { return grid_line(at, y.from, at, major ? y.to : y.from - 4, major); },
      [&](double at, int decade) {
        return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", at,
                           y.from + 18, power_of_ten(decade));
      });
  text += ticks(
      y, [&](double at, bool major) { return grid_line(x.from, at, major ? x.to : x.from + 4, at, major); },
      [&](double at, int decade) {
        return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", x.from - 8,
                           at + 4, power_of_ten(decade));
      });
  return text + fmt::format("<path class=\"axis\" d=\"M{0} {1}V{2}H{3}\"/>\n", x.from, y.to, y.from, x.to);
}

std::string marker(std::size_t number, double x, double y) {
  switch (number % 4) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/>", x, y);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"7\" height=\"7\"/>", x - 3.5, y - 3.5);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l5 8h-10z\"/>", x, y - 5);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l5 5l-5 5l-5 -5z\"/>", x, y - 5);
  }
}

/// The fit between its first and last point, and the points.
std::string curve(const PlotSeries& series, std::size_t number, const Axis& x, const Axis& y) {
  std::string text = fmt::format("<g class=\"series-{}\">", number % colours);
  Range times;
  for (const TimeAndError& point : series.points)
    if (shown(point)) times.include(point.seconds);
  if (series.fit && times.high > times.low)
    text += fmt::format("<path class=\"fit\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>", x.at(times.low),
                        y.at(series.fit->error_at(times.low)), x.at(times.high),
                        y.at(series.fit->error_at(times.high)));
  for (const TimeAndError& point : series.points)
    if (shown(point)) text += marker(number, x.at(point.seconds), y.at(point.error));
  return text + "</g>\n";
}

/// Names beside the plot, in the order of the curves' ends, none on top of another.
std::string labels(const std::vector<PlotSeries>& series, const Axis& x, const Axis& y) {
  struct Label {
    double y = 0;
    std::size_t number = 0;
  };
  std::vector<Label> all;
  for (std::size_t i = 0; i < series.size(); ++i)
    if (!series[i].points.empty() && shown(series[i].points.back()))
      all.push_back({y.at(series[i].points.back().error), i});
  std::sort(all.begin(), all.end(), [](const Label& a, const Label& b) { return a.y < b.y; });
  double next = y.to;
  std::string text;
  for (Label& label : all) {
    label.y = std::max(label.y, next);
    next = label.y + 16;
    text +=
        fmt::format("<g class=\"series-{}\">{}<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text></g>\n",
                    label.number % colours, marker(label.number, x.to + 14, label.y), x.to + 24, label.y + 4,
                    escape_markup(series[label.number].name));
  }
  return text;
}

/// Pixels for the names beside the plot.
double room_of_names(const std::vector<PlotSeries>& series) {
  constexpr double marker = 28, letter = 6.5;  // about, of 12 pixels' height
  std::size_t longest = 4;
  for (const PlotSeries& one : series) longest = std::max(longest, one.name.size());
  return std::min(marker + letter * static_cast<double>(longest), plot_width / 2.0);
}

}  // namespace

std::string escape_markup(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string log_log_plot(const std::string& title, const std::vector<PlotSeries>& series) {
  Range seconds, errors;
  for (const PlotSeries& one : series) {
    for (const TimeAndError& point : one.points) {
      if (!shown(point)) continue;
      seconds.include(point.seconds);
      errors.include(point.error);
    }
  }
  const Axis x = make_axis(seconds, left, plot_width - room_of_names(series));
  const Axis y = make_axis(errors, plot_height - bottom, top);
  std::string text = fmt::format("<g class=\"plot\">\n<text class=\"title\" x=\"{}\" y=\"22\">{}</text>\n",
                                 left, escape_markup(title));
  text += grid(x, y);
  text += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">render time, seconds</text>\n",
                      (x.from + x.to) / 2, plot_height - 12);
  text += fmt::format(
      "<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\">relMSE</text>\n",
      (y.from + y.to) / 2);
  for (std::size_t i = 0; i < series.size(); ++i) text += curve(series[i], i, x, y);
  return text + labels(series, x, y) + "</g>\n";
}

std::string plot_style() {
  // Okabe and Ito's palette, told apart by colour-blind readers too.
  static constexpr const char* light[colours] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                 "#b8860b", "#56b4e9", "#6a3d9a", "#555555"};
  static constexpr const char* dark[colours] = {"#4db2f0", "#ff8c42", "#2fd3a3", "#eba0cb",
                                                "#f0c541", "#8fd0f7", "#b79ae8", "#bbbbbb"};
  std::string text =
      ".plot{font:12px system-ui,sans-serif}.plot text{fill:#333}.plot "
      ".title{font-size:15px;font-weight:600}\n"
      ".plot .grid{stroke:#ddd}.plot .tick{stroke:#999}.plot .axis{fill:none;stroke:#666}\n"
      ".plot .fit{fill:none;stroke:currentColor;stroke-width:1.8}\n";
  const auto series = [](const char* const* palette) {
    std::string rules;
    for (int i = 0; i < colours; ++i)
      rules += fmt::format(".plot .series-{0}{{color:{1};fill:{1}}}.plot .series-{0} .name{{fill:{1}}}\n", i,
                           palette[i]);
    return rules;
  };
  text += series(light);
  text +=
      "@media(prefers-color-scheme:dark){.plot text{fill:#ccc}.plot .grid{stroke:#383c42}"
      ".plot .tick{stroke:#777}.plot .axis{stroke:#999}\n";
  return text + series(dark) + "}\n";
}

}  // namespace castray
