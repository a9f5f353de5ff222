// SPDX-License-Identifier: Apache-2.0
// Error in each band of eccentricity and each retinal region: a test row and its baselines side by side.
#include <fmt/format.h>

#include <algorithm>

#include "report/plot.hpp"
#include "results/csv.hpp"

namespace gazetrace {
namespace {

// The long names of regions, where there is little room below their bars.
std::string short_name(const std::string& part, double width) {
  constexpr double kLetter = 7;
  const bool fits = kLetter * static_cast<double>(part.size()) < width;
  return fits ? part : part == "intermediate" ? "interm." : part == "periphery" ? "periph." : part;
}

constexpr double kBandsBottom = 320;  // of the axes

// Null where there is nothing to draw.
const ResultScore* measured_score(const ResultRow& row, const ResultMetric& metric, const std::string& part) {
  const ResultScore* const score = find_score(row, metric.name, part);
  return score != nullptr && score->value ? score : nullptr;
}

// The rows of a family that have a score in some part.
std::vector<const ResultRow*> scored_rows(const Results& data, const ResultRow& test, const ResultMetric& metric,
                                          const std::vector<std::string>& parts) {
  std::vector<const ResultRow*> rows;
  for (const ResultRow* const row : plotted_family(data, test)) {
    const auto is_measured = [&](const std::string& part) { return measured_score(*row, metric, part) != nullptr; };
    if (std::any_of(parts.begin(), parts.end(), is_measured)) {
      rows.push_back(row);
    }
  }
  return rows;
}

std::vector<Interval> estimates_of(const std::vector<const ResultRow*>& rows, const ResultMetric& metric,
                                   const std::vector<std::string>& parts) {
  std::vector<Interval> estimates;
  for (const ResultRow* const row : rows) {
    for (const std::string& part : parts) {
      if (const ResultScore* const score = measured_score(*row, metric, part); score != nullptr) {
        estimates.push_back(*score->value);
      }
    }
  }
  return estimates;
}

// The room of one row within a part.
struct Slot {
  double left = 0, width = 0;
};

// A score as a bar, or as a point where the scale does not begin at 0, with its interval.
void draw_score(PlotSvg& svg, const ResultScore& score, const ReportRole& role, const PlotScale& y, const Slot& slot,
                bool as_bar) {
  const double middle = slot.left + slot.width / 2;
  const double top = y.at(score.value->mean);
  if (as_bar) {
    svg.add(
        fmt::format("<rect class=\"role-{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\" "
                    "fill-opacity=\"{}\" stroke=\"{}\"/>",
                    escaped(role.name), slot.left + 0.05 * slot.width, top, 0.9 * slot.width, kBandsBottom - top,
                    role.color, score.is_resolved ? "0.85" : "0.15", role.color));
  } else {
    svg.mark(role, middle, top, 4);
  }
  if (score.value->low) {
    svg.add(fmt::format("<path class=\"line\" stroke=\"#1c1c1c\" fill=\"none\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", middle,
                        y.within(*score.value->low), y.within(*score.value->high)));
  }
  if (!score.is_resolved) {
    svg.text(middle, top - 4, "u", "middle", " font-size=\"10\"");
  }
}

// Whether the regions, which contain several bands, begin with this part. Bands without a pixel are not among the
// parts.
bool begins_regions(const std::vector<std::string>& bands, const std::vector<std::string>& parts, std::size_t part) {
  const auto is_band = [&](std::size_t p) { return std::find(bands.begin(), bands.end(), parts[p]) != bands.end(); };
  return part > 0 && is_band(part - 1) && !is_band(part);
}

std::string bands_svg(const Results& data, const std::vector<const ResultRow*>& rows, const ResultMetric& metric,
                      const std::vector<std::string>& parts, const std::string& title) {
  const std::vector<double> values = plotted_range(estimates_of(rows, metric, parts));
  // Bars begin at 0, which a logarithmic scale does not have. Values of metrics where higher is better lie close to
  // each other and far from 0: they are shown as points without bars.
  const bool bars = metric.is_lower_better && !wants_log(values);
  const PlotScale x({0, static_cast<double>(parts.size())}, kPlotLeft, kPlotRight, false, true);
  const PlotScale y(values, kBandsBottom, kPlotTop, wants_log(values), bars);
  std::vector<std::pair<ReportRole, std::string>> entries;
  entries.reserve(rows.size());
  for (const ResultRow* const row : rows) {
    entries.emplace_back(report_role(row->role), row->label);
  }
  PlotSvg svg(kBandsBottom + 56 + legend_height(entries.size()) + 26, title);
  svg.title(title);
  svg.axes(x, y, kPlotLeft, kPlotTop, kPlotRight, kBandsBottom, "eccentricity [deg]; region",
           metric_text(metric) + (metric.is_lower_better ? ", lower is better" : ", higher is better"), false);
  const std::vector<std::string> bands = band_names(data.bands_deg);
  const double part_width = (kPlotRight - kPlotLeft) / static_cast<double>(parts.size());
  const double step = 0.8 * part_width / static_cast<double>(rows.size());
  bool any_unresolved = false;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const double begin = kPlotLeft + part_width * static_cast<double>(p);
    if (begins_regions(bands, parts, p)) {
      svg.add(fmt::format("<path class=\"line\" stroke=\"#8a8a8a\" fill=\"none\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", begin,
                          kPlotTop, kBandsBottom));
    }
    svg.text(begin + part_width / 2, kBandsBottom + 17, short_name(parts[p], part_width), "middle",
             " font-size=\"11\"");
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (const ResultScore* const score = measured_score(*rows[r], metric, parts[p]); score != nullptr) {
        const Slot slot{begin + 0.1 * part_width + step * static_cast<double>(r), step};
        draw_score(svg, *score, report_role(rows[r]->role), y, slot, bars);
        any_unresolved = any_unresolved || !score->is_resolved;
      }
    }
  }
  const double end = svg.legend(entries, 24, kBandsBottom + 52);
  svg.text(24, end + 16,
           std::string("Lines: intervals at 95 %.") +
               (any_unresolved ? " u: unresolved, under the reference's own noise." : ""),
           "start", " font-size=\"11\"");
  return svg.str();
}

std::string bands_csv(const std::vector<const ResultRow*>& rows, const ResultMetric& metric,
                      const std::vector<std::string>& parts) {
  std::string csv = "id,role,label,part," + csv_cell(metric.name) + ",low,high,resolved\n";
  for (const ResultRow* const row : rows) {
    for (const std::string& part : parts) {
      if (const ResultScore* const score = find_score(*row, metric.name, part); score != nullptr) {
        csv += fmt::format("{},{},{},{},{},{}\n", csv_cell(row->id), to_string(row->role), csv_cell(row->label), part,
                           csv_interval(score->value), score->is_resolved ? 1 : 0);
      }
    }
  }
  return csv;
}

}  // namespace

std::optional<ReportPlot> bands_plot(const Results& data, const ResultRow& test, const ResultMetric& metric) {
  const std::vector<std::string> parts = scored_parts(data);
  const std::vector<const ResultRow*> rows = scored_rows(data, test, metric, parts);
  if (rows.empty()) {
    return std::nullopt;
  }
  ReportPlot plot{"bands", test.scene, test.gaze, metric.name, test.id, "", "", "", ""};
  plot.name = plot_file_name({"bands", test.id, metric.name});
  plot.title = fmt::format("{} by eccentricity and region, {}: {}", metric.name,
                           scene_gaze_text({test.scene, test.gaze}), test.label);
  plot.svg = bands_svg(data, rows, metric, parts, plot.title);
  plot.csv = bands_csv(rows, metric, parts);
  return plot;
}

}  // namespace gazetrace
