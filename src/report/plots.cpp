// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "report/plot.hpp"

namespace gazetrace {

std::vector<ReportPlot> report_plots(const Results& data) {
  std::vector<ReportPlot> plots;
  const auto add = [&](std::optional<ReportPlot> plot) {
    if (plot) {
      plots.push_back(std::move(*plot));
    }
  };
  for (const ResultMetric& metric : data.metrics) {
    for (const SceneGaze& both : scene_gazes(data)) {
      add(pareto_plot(data, both, metric));
    }
    for (const ResultRow* const test : test_rows(data)) {
      add(time_plot(data, *test, metric));
      add(bands_plot(data, *test, metric));
    }
  }
  // Names that differ only in letters that a file name cannot hold are told apart by a number.
  std::set<std::string> names;
  for (ReportPlot& plot : plots) {
    std::string name = plot.name;
    for (int n = 2; !names.insert(name).second; ++n) {
      name = plot.name + "-" + std::to_string(n);
    }
    plot.name = name;
  }
  return plots;
}

}  // namespace gazetrace
