// SPDX-License-Identifier: Apache-2.0
// What the plots of a gaze report are drawn with, and the plots.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/svg.hpp"
#include "gazetrace/gaze_report.hpp"

namespace gazetrace {

inline constexpr double kSmallWidth = 400, kSmallHeight = 300;  // of plots that stand beside each other
inline constexpr double kWideWidth = 900;
inline constexpr const char* kLeftColor = "#0072b2";
inline constexpr const char* kRightColor = "#d55e00";
inline constexpr const char* kTraceColor = "#333333";

class Drawing {
 public:
  Drawing(double width, double height, const std::string& title);
  void add(const std::string& element) { text_ += element + '\n'; }
  // `anchor` is start, middle or end.
  void text(double x, double y, const std::string& words, const char* anchor = "start", const char* more = "");
  // Grid lines with their values, and what stands beside the axes. A logarithmic axis holds decimal logarithms.
  void x_axis(const Axis& x, const Axis& y, double count, const std::string& label, bool is_log = false);
  void y_axis(const Axis& x, const Axis& y, double count, const std::string& label, bool is_log = false);
  void frame(const Axis& x, const Axis& y);
  [[nodiscard]] std::string str() const { return text_ + "</svg>\n"; }

 private:
  std::string text_;
};

// Values over time, one for each sample; NaN where there is none.
struct GazeTrace {
  std::string name;
  const char* color = kTraceColor;
  std::vector<double> values;
};

GazePlot main_sequence_plot(const std::vector<EyeEvent>& events, const MainSequence& fit);
// Shares of all in equal bins from 0 on.
GazePlot histogram_plot(const std::string& name, const std::string& title, const std::string& label,
                        std::vector<double> values, const char* color);
// `seconds`: of each sample. Empty where no trace has a value.
std::optional<GazePlot> trace_plot(const std::string& name, const std::string& title, const std::string& label,
                                   const std::vector<double>& seconds, const std::vector<GazeTrace>& traces);
// The picture as a data URI; empty: none. Error(input) where it cannot be read or is neither PNG nor JPEG.
std::string picture_uri(const std::string& path);
GazePlot scanpath_plot(const GazeLog& log, const std::vector<EyeEvent>& events, const std::string& picture);
// Empty where the log is not of a screen whose angles are known, or without fixations.
std::optional<GazePlot> heat_map_plot(const GazeLog& log, const std::vector<EyeEvent>& events,
                                      const std::string& picture, double sigma_deg);

}  // namespace gazetrace
