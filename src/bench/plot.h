#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/statistics.h"

namespace castray {

/// One curve of a plot: its points, joined by the fit.
struct PlotSeries {
  std::string name;
  std::vector<TimeAndError> points;
  std::optional<PowerLaw> fit;
};

/// Error over seconds on logarithmic axes, as an SVG group of plot_width x plot_height; series are told apart
/// by colour (CSS classes series-0 ...), marker and a label at their end. Points without positive seconds and
/// error are left out.
std::string log_log_plot(const std::string& title, const std::vector<PlotSeries>& series);

inline constexpr int plot_width = 480, plot_height = 340;

/// The CSS that the plots need, light and dark.
std::string plot_style();

/// & < > " as entities, for text and attributes of SVG and HTML.
std::string escape_markup(const std::string& text);

}  // namespace castray
