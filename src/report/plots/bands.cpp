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

}  // namespace

std::optional<ReportPlot> bands_plot(const Results& data, const ResultRow& test, const ResultMetric& metric) {
  const std::vector<std::string> parts = scored_parts(data);
  std::vector<const ResultRow*> rows;
  std::vector<Interval> estimates;
  for (const ResultRow* const row : plotted_family(data, test)) {
    bool any = false;
    for (const std::string& part : parts) {
      const ResultScore* const score = find_score(*row, metric.name, part);
      if (score != nullptr && score->value) {
        any = true;
        estimates.push_back(*score->value);
      }
    }
    if (any) {
      rows.push_back(row);
    }
  }
  if (rows.empty()) {
    return std::nullopt;
  }
  const std::vector<double> values = plotted_range(estimates);
  ReportPlot plot{"bands", test.scene, test.gaze, metric.name, test.id, "", "", "", ""};
  plot.name = plot_file_name({"bands", test.id, metric.name});
  plot.title = fmt::format("{} by eccentricity and region, {}: {}", metric.name,
                           scene_gaze_text({test.scene, test.gaze}), test.label);

  // Bars begin at 0, which a logarithmic scale does not have. Values of metrics where higher is better lie close to
  // each other and far from 0: they are shown as points without bars.
  const bool bars = metric.is_lower_better && !wants_log(values);
  constexpr double kLeft = 84, kTop = kPlotTop, kBottom = 320;
  const double right = kPlotWidth - 26;
  const PlotScale x({0, static_cast<double>(parts.size())}, kLeft, right, false, true);
  const PlotScale y(values, kBottom, kTop, wants_log(values), bars);
  std::vector<std::pair<ReportRole, std::string>> entries;
  entries.reserve(rows.size());
  for (const ResultRow* const row : rows) {
    entries.emplace_back(report_role(row->role), row->label);
  }
  PlotSvg svg(kBottom + 56 + legend_height(entries.size()) + 26, plot.title);
  svg.title(plot.title);
  svg.axes(x, y, kLeft, kTop, right, kBottom, "eccentricity [deg]; region",
           metric_text(metric) + (metric.is_lower_better ? ", lower is better" : ", higher is better"), false);
  const std::vector<std::string> bands = band_names(data.bands_deg);
  const auto is_band = [&](const std::string& part) {
    return std::find(bands.begin(), bands.end(), part) != bands.end();
  };
  const double part_width = (right - kLeft) / static_cast<double>(parts.size());
  const double step = 0.8 * part_width / static_cast<double>(rows.size());
  bool any_unresolved = false;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const double begin = kLeft + part_width * static_cast<double>(p);
    // A line sets the regions apart, which contain several bands. Bands without a pixel are not among the parts.
    if (p > 0 && is_band(parts[p - 1]) && !is_band(parts[p])) {
      svg.add(fmt::format("<path class=\"line\" stroke=\"#8a8a8a\" fill=\"none\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", begin,
                          kTop, kBottom));
    }
    svg.text(begin + part_width / 2, kBottom + 17, short_name(parts[p], part_width), "middle", " font-size=\"11\"");
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const ResultScore* const score = find_score(*rows[r], metric.name, parts[p]);
      if (score == nullptr || !score->value) {
        continue;
      }
      const ReportRole role = report_role(rows[r]->role);
      const double left = begin + 0.1 * part_width + step * static_cast<double>(r);
      const double top = y.at(score->value->mean);
      if (bars) {
        svg.add(fmt::format(
            "<rect class=\"role-{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\" "
            "fill-opacity=\"{}\" stroke=\"{}\"/>",
            escaped(role.name), left + 0.05 * step, top, 0.9 * step, kBottom - top, role.color,
            score->is_resolved ? "0.85" : "0.15", role.color));
      } else {
        svg.mark(role, left + step / 2, top, 4);
      }
      if (score->value->low) {
        svg.add(fmt::format("<path class=\"line\" stroke=\"#1c1c1c\" fill=\"none\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>",
                            left + step / 2, y.within(*score->value->low), y.within(*score->value->high)));
      }
      if (!score->is_resolved) {
        any_unresolved = true;
        svg.text(left + step / 2, top - 4, "u", "middle", " font-size=\"10\"");
      }
    }
  }
  const double end = svg.legend(entries, 24, kBottom + 52);
  svg.text(24, end + 16,
           std::string("Lines: intervals at 95 %.") +
               (any_unresolved ? " u: unresolved, under the reference's own noise." : ""),
           "start", " font-size=\"11\"");
  plot.svg = svg.str();

  plot.csv = "id,role,label,part," + csv_cell(metric.name) + ",low,high,resolved\n";
  for (const ResultRow* const row : rows) {
    for (const std::string& part : parts) {
      if (const ResultScore* const score = find_score(*row, metric.name, part); score != nullptr) {
        plot.csv += fmt::format("{},{},{},{},{},{}\n", csv_cell(row->id), to_string(row->role), csv_cell(row->label),
                                part, csv_interval(score->value), score->is_resolved ? 1 : 0);
      }
    }
  }
  return plot;
}

}  // namespace gazetrace
