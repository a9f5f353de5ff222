// SPDX-License-Identifier: Apache-2.0
// Error over time: every run of a scene and gaze with its intervals, the Pareto fronts, and the reference's own noise.
#include <fmt/format.h>

#include <algorithm>

#include "report/plot.hpp"
#include "results/csv.hpp"

namespace gazetrace {
namespace {

constexpr double kParetoBottom = 350;  // of the axes

struct Point {
  const ResultRow* row = nullptr;
  Interval time_s, score;
  bool is_resolved = true;
};

std::vector<Point> points_of(const Results& data, const SceneGaze& both, const std::string& metric) {
  std::vector<Point> points;
  for (const ResultRow& row : data.rows) {
    const ResultScore* const score = find_score(row, metric, "whole");
    if (row.role != RowRole::wrong_gaze && row.scene == both.scene && row.gaze == both.gaze && row.time_s &&
        score != nullptr && score->value) {
      points.push_back({&row, *row.time_s, *score->value, score->is_resolved});
    }
  }
  return points;
}

struct Box {
  double left, top, right, bottom;
};

double overlap(const Box& a, const Box& b) {
  return std::max(0.0, std::min(a.right, b.right) - std::max(a.left, b.left)) *
         std::max(0.0, std::min(a.bottom, b.bottom) - std::max(a.top, b.top));
}

// Words beside marks, where they cover marks and other words least.
class Labels {
 public:
  explicit Labels(const Box& plot) : plot_(plot) {}

  void keep_clear(double x, double y) { taken_.push_back({x - 6, y - 6, x + 6, y + 6}); }
  void put(double x, double y, const std::string& words, PlotSvg& svg) {
    constexpr double kLetter = 6.6, kHeight = 10;  // at the size of the font below
    const double width = kLetter * static_cast<double>(words.size());
    Box best{};
    bool is_right = true;
    double least = -1;
    double preference = 0;  // for the places that come first, which are nearer
    for (const double rise : {7.0, -15.0, 20.0, -28.0, 33.0, -41.0}) {  // from the mark up to the baseline
      for (const bool right : {true, false}) {
        const double left = right ? x + 8 : x - 8 - width;
        const Box box{left, y - rise - kHeight, left + width, y - rise + 2};
        double cost = preference + 4 * (width * (kHeight + 2) - overlap(box, plot_));
        for (const Box& other : taken_) {
          cost += overlap(box, other);
        }
        preference += 1;
        if (least < 0 || cost < least) {
          least = cost;
          best = box;
          is_right = right;
        }
      }
    }
    taken_.push_back(best);
    svg.text(is_right ? best.left : best.right, best.bottom - 2, words, is_right ? "start" : "end",
             " font-size=\"11\"");
  }

 private:
  Box plot_;
  std::vector<Box> taken_;
};

// The points of a front that the sweep has found, in the order of time.
struct Front {
  std::vector<const Point*> points;
  std::string name;  // of its reference, where the scene and gaze have several
};

// Scores against different references are not comparable, so each reference has a front of its own; its name is that of
// the scene and gaze followed by the key of the reference.
std::vector<Front> fronts_of(const Results& data, const SceneGaze& both, const std::string& metric,
                             const std::vector<Point>& points) {
  std::vector<Front> fronts;
  const auto of_metric = data.pareto.find(metric);
  if (of_metric == data.pareto.end()) {
    return fronts;
  }
  const std::string place = both.scene + "/" + both.gaze;
  for (const auto& [name, ids] : of_metric->second) {
    if (name != place && !name.starts_with(place + "/")) {
      continue;
    }
    Front front;
    front.name = name == place ? "" : "reference " + name.substr(place.size() + 1);
    for (const Point& point : points) {
      if (std::find(ids.begin(), ids.end(), point.row->id) != ids.end()) {
        front.points.push_back(&point);
      }
    }
    std::sort(front.points.begin(), front.points.end(),
              [](const Point* a, const Point* b) { return a->time_s.mean < b->time_s.mean; });
    fronts.push_back(std::move(front));
  }
  return fronts;
}

void draw_front(const Front& front, const PlotScale& x, const PlotScale& y, PlotSvg& svg) {
  if (front.points.empty()) {
    return;
  }
  std::string path;
  for (const Point* const point : front.points) {
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x.at(point->time_s.mean), y.at(point->score.mean));
  }
  if (front.points.size() > 1) {
    svg.add(fmt::format(
        "<path class=\"front\" stroke=\"#0072b2\" stroke-opacity=\"0.45\" stroke-width=\"3\" fill=\"none\" d=\"{}\"/>",
        path));
  }
  if (!front.name.empty()) {
    const Point& last = *front.points.back();
    const double px = x.at(last.time_s.mean);
    svg.text(px, y.at(last.score.mean) + 17, "front of " + front.name, px < kPlotWidth / 2 ? "start" : "end",
             " font-size=\"11\"");
  }
}

std::string front_words(const std::vector<Front>& fronts) {
  const auto lines =
      std::count_if(fronts.begin(), fronts.end(), [](const Front& front) { return front.points.size() > 1; });
  const std::string bars = "Bars: intervals at 95 %.";
  if (fronts.size() > 1) {
    return "Pareto fronts (broad lines) are of one reference each: others' scores do not compare. " + bars;
  }
  return lines > 0 ? "Broad line: Pareto front. " + bars : bars;
}

// The reference's own noise, where it lies within the axes.
void draw_floors(PlotSvg& svg, const Results& data, const SceneGaze& both, const std::string& metric,
                 const PlotScale& y) {
  const std::vector<const ResultReference*> scenes = find_references(data, both);
  for (const ResultReference* const scene : scenes) {
    const std::optional<double> floor = find_floor(scene, both.gaze, metric, "whole");
    if (floor && y.at(*floor) > kPlotTop && y.at(*floor) < kParetoBottom) {
      svg.add(
          fmt::format("<path class=\"line\" stroke=\"#1c1c1c\" stroke-dasharray=\"2 4\" fill=\"none\" "
                      "d=\"M{:.1f} {:.1f}H{:.1f}\"/>",
                      kPlotLeft, y.at(*floor), kPlotRight));
      svg.text(kPlotRight - 4, y.at(*floor) - 5, reference_text(*scene, scenes.size()) + " from itself", "end",
               " font-size=\"11\"");
    }
  }
}

// A mark with its intervals in time and in score.
void draw_point(PlotSvg& svg, const Point& point, const PlotScale& x, const PlotScale& y) {
  const ReportRole role = report_role(point.row->role);
  const double px = x.at(point.time_s.mean);
  const double py = y.at(point.score.mean);
  const std::string open = fmt::format("class=\"role-{}\" stroke=\"{}\" fill=\"none\"", escaped(role.name), role.color);
  if (point.time_s.low) {
    svg.add(fmt::format("<path {} d=\"M{:.1f} {:.1f}H{:.1f}\"/>", open, x.within(*point.time_s.low), py,
                        x.within(*point.time_s.high)));
  }
  if (point.score.low) {
    svg.add(fmt::format("<path {} d=\"M{:.1f} {:.1f}V{:.1f}\"/>", open, px, y.within(*point.score.low),
                        y.within(*point.score.high)));
  }
  svg.mark(role, px, py);
}

// The numbers of the points, by which the legend names them.
void draw_numbers(PlotSvg& svg, const std::vector<Point>& points, const PlotScale& x, const PlotScale& y) {
  Labels labels({kPlotLeft, kPlotTop, kPlotRight, kParetoBottom});
  for (const Point& point : points) {
    labels.keep_clear(x.at(point.time_s.mean), y.at(point.score.mean));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& point = points[i];
    labels.put(x.at(point.time_s.mean), y.at(point.score.mean),
               std::to_string(i + 1) + (point.is_resolved ? "" : " (unresolved)"), svg);
  }
}

std::string pareto_svg(const Results& data, const SceneGaze& both, const ResultMetric& metric,
                       const std::vector<Point>& points, const std::vector<Front>& fronts, const std::string& title) {
  std::vector<Interval> all_times;
  std::vector<Interval> all_scores;
  std::vector<std::pair<ReportRole, std::string>> entries;
  for (const Point& point : points) {
    all_times.push_back(point.time_s);
    all_scores.push_back(point.score);
    entries.emplace_back(report_role(point.row->role), fmt::format("{}  {}", entries.size() + 1, point.row->label));
  }
  const std::vector<double> times = plotted_range(all_times);
  const std::vector<double> scores = plotted_range(all_scores);
  const PlotScale x(times, kPlotLeft, kPlotRight, wants_log(times));
  const PlotScale y(scores, kParetoBottom, kPlotTop, wants_log(scores));
  PlotSvg svg(kParetoBottom + 56 + legend_height(entries.size()) + 26, title);
  svg.title(title);
  svg.axes(x, y, kPlotLeft, kPlotTop, kPlotRight, kParetoBottom, "time of a frame [s]",
           metric_text(metric) + (metric.is_lower_better ? ", lower is better" : ", higher is better"));
  draw_floors(svg, data, both, metric.name, y);
  for (const Front& front : fronts) {
    draw_front(front, x, y, svg);
  }
  for (const Point& point : points) {
    draw_point(svg, point, x, y);
  }
  draw_numbers(svg, points, x, y);
  const double end = svg.legend(entries, 24, kParetoBottom + 52);
  svg.text(24, end + 16, front_words(fronts), "start", " font-size=\"11\"");
  return svg.str();
}

std::string pareto_csv(const ResultMetric& metric, const std::vector<Point>& points, const std::vector<Front>& fronts) {
  std::string csv =
      "number,id,role,label,time_s,time_s_low,time_s_high," + csv_cell(metric.name) + ",low,high,resolved,front\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& point = points[i];
    const bool on_front = std::any_of(fronts.begin(), fronts.end(), [&](const Front& front) {
      return std::find(front.points.begin(), front.points.end(), &point) != front.points.end();
    });
    csv += fmt::format("{},{},{},{},{},{},{},{}\n", i + 1, csv_cell(point.row->id), to_string(point.row->role),
                       csv_cell(point.row->label), csv_interval(point.time_s), csv_interval(point.score),
                       point.is_resolved ? 1 : 0, on_front ? 1 : 0);
  }
  return csv;
}

}  // namespace

std::optional<ReportPlot> pareto_plot(const Results& data, const SceneGaze& both, const ResultMetric& metric) {
  const std::vector<Point> points = points_of(data, both, metric.name);
  if (points.empty()) {
    return std::nullopt;
  }
  const std::vector<Front> fronts = fronts_of(data, both, metric.name, points);
  ReportPlot plot{"pareto", both.scene, both.gaze, metric.name, "", "", "", "", ""};
  plot.name = plot_file_name({"pareto", both.scene, both.gaze, metric.name});
  plot.title = fmt::format("{} against time, {}", metric.name, scene_gaze_text(both));
  plot.svg = pareto_svg(data, both, metric, points, fronts, plot.title);
  plot.csv = pareto_csv(metric, points, fronts);
  return plot;
}

}  // namespace gazetrace
