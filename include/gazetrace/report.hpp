// SPDX-License-Identifier: Apache-2.0
// What a sweep measured, as a page to look at, as diagrams for papers and in sentences. Results in, texts out: the only
// files read are the pictures that the results name.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/results.hpp"

namespace gazetrace {

// A diagram that stands on its own, with the numbers that it shows.
struct ReportPlot {
  std::string kind;  // "pareto", "bands", "time"
  std::string scene, gaze, metric;
  std::string row;   // id of the test row; empty for "pareto", which shows all of a scene and gaze
  std::string name;  // file name without suffix, distinct
  std::string title;
  std::string svg, csv;
};
std::vector<ReportPlot> report_plots(const Results& results);

// Findings in words, made from the numbers. Two values count as different where their intervals do not overlap.
struct ReportFindings {
  std::string headline;              // what was found, in one or two sentences
  std::vector<std::string> summary;  // one or two sentences for each test row
  std::string tally;                 // how the comparisons with baselines of the same cost came out
  std::vector<std::string> losses;   // where a baseline is better or faster
  std::vector<std::string> caveats;  // what the measurements cannot say
};
ReportFindings report_findings(const Results& results);

struct ReportSettings {
  double max_mib = 5;  // limit of the page; to stay below it, pictures are reduced and then left out
  int threads = 0;     // 0: as many as the machine has
};

// The page: one file that needs nothing else. Pictures that cannot be read become warnings.
struct ReportPage {
  std::string html;
  Warnings warnings;
};
ReportPage report_page(const Results& results, const ReportSettings& settings);

}  // namespace gazetrace
