// SPDX-License-Identifier: Apache-2.0
// Time and error of every frame over video time in two diagrams, one above the other, and what the eye did below them.
#include <fmt/format.h>

#include <algorithm>

#include "report/plot.hpp"
#include "results/csv.hpp"

namespace gazetrace {
namespace {

struct Series {
  const ResultRow* row = nullptr;
  std::vector<double> t_s;
  std::vector<std::optional<double>> values;
};

std::optional<double> frame_score(const ResultFrame& frame, const std::string& metric) {
  const auto found = frame.scores.find(metric);
  return found == frame.scores.end() ? std::nullopt : found->second;
}

// The line of a series; it breaks where a value is missing.
void draw(PlotSvg& svg, const Series& series, const PlotScale& x, const PlotScale& y) {
  const ReportRole role = report_role(series.row->role);
  std::string path;
  bool open = false;
  for (std::size_t i = 0; i < series.t_s.size(); ++i) {
    if (!series.values[i]) {
      open = false;
      continue;
    }
    const double px = x.at(series.t_s[i]);
    const double py = y.at(*series.values[i]);
    path += fmt::format("{}{:.1f} {:.1f}", open ? "L" : "M", px, py);
    open = true;
    if (series.t_s.size() <= 40) {
      svg.mark(role, px, py, 3);
    }
  }
  svg.add(fmt::format(
      "<path class=\"role-{}\" stroke=\"{}\" stroke-width=\"1.6\" stroke-dasharray=\"{}\" fill=\"none\" d=\"{}\"/>",
      escaped(role.name), role.color, role.dash.empty() ? "none" : role.dash, path));
}

std::vector<double> present(const std::vector<Series>& all) {
  std::vector<double> values;
  for (const Series& series : all) {
    for (const auto& value : series.values) {
      if (value) {
        values.push_back(*value);
      }
    }
  }
  return values;
}

const char* event_color(const std::string& event) {
  return event == "fixation"                          ? "#7fb7a3"
         : event == "in-flight" || event == "saccade" ? "#e0a458"
         : event == "blink"                           ? "#9a86b8"
                                                      : "#bdbdbd";
}

// The runs of a family, frame by frame.
struct FamilyOverTime {
  std::vector<Series> times, scores;
  std::vector<double> t_s;  // of all frames
};

FamilyOverTime family_over_time(const Results& data, const ResultRow& test, const std::string& metric) {
  FamilyOverTime family;
  for (const ResultRow* const row : plotted_family(data, test)) {
    Series time{row, {}, {}};
    Series score{row, {}, {}};
    for (const ResultFrame& frame : row->frames) {
      time.t_s.push_back(frame.t_s);
      time.values.push_back(frame.time_s);
      score.t_s.push_back(frame.t_s);
      score.values.push_back(frame_score(frame, metric));
      family.t_s.push_back(frame.t_s);
    }
    family.times.push_back(std::move(time));
    family.scores.push_back(std::move(score));
  }
  return family;
}

// What the eye did, from the time of a frame to that of the next, and the words for the colors.
void draw_events(PlotSvg& svg, const std::vector<ResultFrame>& frames, const PlotScale& x, double top) {
  constexpr double kHeight = 10;
  std::vector<std::string> events;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const ResultFrame& frame = frames[i];
    const double from = x.at(frame.t_s);
    const double to = i + 1 < frames.size() ? x.at(frames[i + 1].t_s) : std::max(from + 4, kPlotRight);
    svg.add(fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:g}\" fill=\"{}\"/>", from, top,
                        to - from, kHeight, event_color(frame.event)));
    if (std::find(events.begin(), events.end(), frame.event) == events.end()) {
      events.push_back(frame.event);
    }
  }
  double left = kPlotLeft;
  for (const std::string& event : events) {
    svg.add(fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"10\" height=\"10\" fill=\"{}\"/>", left, top + 16,
                        event_color(event)));
    svg.text(left + 14, top + 25, event == "none" ? "eye: not known" : "eye: " + event, "start", " font-size=\"11\"");
    left += 120;
  }
}

std::string time_svg(const FamilyOverTime& family, const ResultRow& test, const ResultMetric& metric,
                     const std::string& title) {
  constexpr double kMiddle = 190, kSecond = 214, kBottom = 380, kStrip = kBottom + 26;
  std::vector<std::pair<ReportRole, std::string>> entries;
  entries.reserve(family.times.size());
  for (const Series& series : family.times) {
    entries.emplace_back(report_role(series.row->role), series.row->label);
  }
  PlotSvg svg(kBottom + 78 + legend_height(entries.size()) + 26, title);
  svg.title(title);
  const std::vector<double> all_times = present(family.times);
  const std::vector<double> all_scores = present(family.scores);
  const PlotScale x(family.t_s, kPlotLeft, kPlotRight, false);
  const PlotScale y_time(all_times, kMiddle, kPlotTop, wants_log(all_times), true);
  const PlotScale y_score(all_scores, kBottom, kSecond, wants_log(all_scores), false);
  svg.axes(x, y_time, kPlotLeft, kPlotTop, kPlotRight, kMiddle, "", "time of a frame [s]", false);
  svg.axes(x, y_score, kPlotLeft, kSecond, kPlotRight, kBottom, "", metric_text(metric));
  for (const Series& series : family.times) {
    draw(svg, series, x, y_time);
  }
  for (const Series& series : family.scores) {
    draw(svg, series, x, y_score);
  }
  draw_events(svg, test.frames, x, kStrip);
  svg.text(kPlotRight, kStrip + 25, "video time [s]", "end");
  const double end = svg.legend(entries, 24, kBottom + 74);
  svg.text(24, end + 14, metric.is_lower_better ? "Lower is better in both." : "Below, higher is better.", "start",
           " font-size=\"11\"");
  return svg.str();
}

std::string time_csv(const FamilyOverTime& family, const ResultMetric& metric) {
  std::string csv = "id,role,label,frame,t_s,event,time_s," + csv_cell(metric.name) + "\n";
  for (const Series& series : family.times) {
    for (const ResultFrame& frame : series.row->frames) {
      csv += fmt::format("{},{},{},{},{},{},{},{}\n", csv_cell(series.row->id), to_string(series.row->role),
                         csv_cell(series.row->label), frame.index, csv_number(frame.t_s), csv_cell(frame.event),
                         csv_number(frame.time_s), csv_number(frame_score(frame, metric.name)));
    }
  }
  return csv;
}

}  // namespace

std::optional<ReportPlot> time_plot(const Results& data, const ResultRow& test, const ResultMetric& metric) {
  const FamilyOverTime family = family_over_time(data, test, metric.name);
  if (present(family.times).empty() && present(family.scores).empty()) {
    return std::nullopt;
  }
  ReportPlot plot{"time", test.scene, test.gaze, metric.name, test.id, "", "", "", ""};
  plot.name = plot_file_name({"time", test.id, metric.name});
  plot.title =
      fmt::format("Speed and {} over time, {}: {}", metric.name, scene_gaze_text({test.scene, test.gaze}), test.label);
  plot.svg = time_svg(family, test, metric, plot.title);
  plot.csv = time_csv(family, metric);
  return plot;
}

}  // namespace gazetrace
