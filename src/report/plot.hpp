// SPDX-License-Identifier: Apache-2.0
// What the diagrams are drawn with. Colors and sizes are attributes, so that a file looks the same everywhere; classes
// let the page change colors for a dark background.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/svg.hpp"
#include "report/words.hpp"

namespace gazetrace {

inline constexpr double kPlotWidth = 640;
// Where axes lie; above them is room for a title of two lines.
inline constexpr double kPlotLeft = 84, kPlotRight = kPlotWidth - 26, kPlotTop = 44;

// Maps values to picture coordinates on a linear or logarithmic scale.
class PlotScale {
 public:
  // A scale that holds all `values` with some room. It is logarithmic where that is asked for and all are positive.
  PlotScale(const std::vector<double>& values, double begin, double end, bool log, bool from_zero = false);
  [[nodiscard]] double at(double value) const;
  // The coordinate, kept within the ends of the scale: for intervals that are wider than the picture.
  [[nodiscard]] double within(double value) const;
  [[nodiscard]] std::vector<double> ticks(double count) const;
  [[nodiscard]] bool is_log() const { return log_; }

 private:
  bool log_ = false;
  Axis axis_;  // holds logarithms where the scale is logarithmic
};

// Whether a range of positive values is so wide that it is better shown on a logarithmic scale.
bool wants_log(const std::vector<double>& values);

// The values that a scale should hold: all means, and intervals as far as they do not squeeze the means together.
std::vector<double> plotted_range(const std::vector<Interval>& estimates);

class PlotSvg {
 public:
  PlotSvg(double height, const std::string& title);
  void add(const std::string& element) { text_ += element + '\n'; }
  // `anchor` is start, middle or end.
  void text(double x, double y, const std::string& words, const char* anchor = "start", const char* more = "");
  void mark(const ReportRole& role, double x, double y, double radius = 5);
  // Draws the frame, ticks and labels of a diagram whose scales end at its borders.
  void axes(const PlotScale& x, const PlotScale& y, double left, double top, double right, double bottom,
            const std::string& x_label, const std::string& y_label, bool with_x_numbers = true);
  // Above the axes, in two lines where one is too short.
  void title(const std::string& words);
  // Draws the marks and words of runs in two columns below a diagram; returns where the legend ends.
  double legend(const std::vector<std::pair<ReportRole, std::string>>& entries, double left, double top);
  [[nodiscard]] std::string str() const { return text_ + "</svg>\n"; }

 private:
  std::string text_;
};

// The height of a legend in two columns.
double legend_height(std::size_t entries);

std::string plot_file_name(const std::vector<std::string>& parts);  // letters, digits, . _ -

// The first is drawn for each scene, gaze and metric, the others for each test row and metric. Empty where there is
// nothing to draw.
std::optional<ReportPlot> pareto_plot(const Results& data, const SceneGaze& both, const ResultMetric& metric);
std::optional<ReportPlot> bands_plot(const Results& data, const ResultRow& test, const ResultMetric& metric);
std::optional<ReportPlot> time_plot(const Results& data, const ResultRow& test, const ResultMetric& metric);

}  // namespace gazetrace
