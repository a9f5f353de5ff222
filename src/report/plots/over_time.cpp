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

}  // namespace

std::optional<ReportPlot> time_plot(const Results& data, const ResultRow& test, const ResultMetric& metric) {
  std::vector<Series> times;
  std::vector<Series> scores;
  std::vector<double> t_s;
  for (const ResultRow* const row : plotted_family(data, test)) {
    Series time{row, {}, {}};
    Series score{row, {}, {}};
    for (const ResultFrame& frame : row->frames) {
      time.t_s.push_back(frame.t_s);
      time.values.push_back(frame.time_s);
      score.t_s.push_back(frame.t_s);
      score.values.push_back(frame_score(frame, metric.name));
      t_s.push_back(frame.t_s);
    }
    times.push_back(std::move(time));
    scores.push_back(std::move(score));
  }
  const std::vector<double> all_times = present(times);
  const std::vector<double> all_scores = present(scores);
  if (all_times.empty() && all_scores.empty()) {
    return std::nullopt;
  }
  ReportPlot plot{"time", test.scene, test.gaze, metric.name, test.id, "", "", "", ""};
  plot.name = plot_file_name({"time", test.id, metric.name});
  plot.title =
      fmt::format("Speed and {} over time, {}: {}", metric.name, scene_gaze_text({test.scene, test.gaze}), test.label);

  constexpr double kLeft = 84, kTop = kPlotTop, kMiddle = 190, kSecond = 214, kBottom = 380, kStrip = 10;
  const double right = kPlotWidth - 26;
  std::vector<std::pair<ReportRole, std::string>> entries;
  entries.reserve(times.size());
  for (const Series& series : times) {
    entries.emplace_back(report_role(series.row->role), series.row->label);
  }
  PlotSvg svg(kBottom + 78 + legend_height(entries.size()) + 26, plot.title);
  svg.title(plot.title);
  const PlotScale x(t_s, kLeft, right, false);
  const PlotScale y_time(all_times, kMiddle, kTop, wants_log(all_times), true);
  const PlotScale y_score(all_scores, kBottom, kSecond, wants_log(all_scores), false);
  svg.axes(x, y_time, kLeft, kTop, right, kMiddle, "", "time of a frame [s]", false);
  svg.axes(x, y_score, kLeft, kSecond, right, kBottom, "", metric_text(metric));
  for (const Series& series : times) {
    draw(svg, series, x, y_time);
  }
  for (const Series& series : scores) {
    draw(svg, series, x, y_score);
  }
  // What the eye did, from the time of a frame to that of the next.
  std::vector<std::string> events;
  const double strip = kBottom + 26;
  for (std::size_t i = 0; i < test.frames.size(); ++i) {
    const ResultFrame& frame = test.frames[i];
    const double from = x.at(frame.t_s);
    const double to = i + 1 < test.frames.size() ? x.at(test.frames[i + 1].t_s) : std::max(from + 4, right);
    svg.add(fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:g}\" fill=\"{}\"/>", from, strip,
                        to - from, kStrip, event_color(frame.event)));
    if (std::find(events.begin(), events.end(), frame.event) == events.end()) {
      events.push_back(frame.event);
    }
  }
  double event_x = kLeft;
  for (const std::string& event : events) {
    svg.add(fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"10\" height=\"10\" fill=\"{}\"/>", event_x, strip + 16,
                        event_color(event)));
    svg.text(event_x + 14, strip + 25, event == "none" ? "eye: not known" : "eye: " + event, "start",
             " font-size=\"11\"");
    event_x += 120;
  }
  svg.text(right, strip + 25, "video time [s]", "end");
  const double end = svg.legend(entries, 24, kBottom + 74);
  svg.text(24, end + 14, metric.is_lower_better ? "Lower is better in both." : "Below, higher is better.", "start",
           " font-size=\"11\"");
  plot.svg = svg.str();

  plot.csv = "id,role,label,frame,t_s,event,time_s," + csv_cell(metric.name) + "\n";
  for (const Series& series : times) {
    for (const ResultFrame& frame : series.row->frames) {
      plot.csv += fmt::format("{},{},{},{},{},{},{},{}\n", csv_cell(series.row->id), to_string(series.row->role),
                              csv_cell(series.row->label), frame.index, csv_number(frame.t_s), csv_cell(frame.event),
                              csv_number(frame.time_s), csv_number(frame_score(frame, metric.name)));
    }
  }
  return plot;
}

}  // namespace gazetrace
