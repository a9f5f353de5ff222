// SPDX-License-Identifier: Apache-2.0
// What a sweep measured, as a page to look at, as diagrams for papers and as tables. Values in, texts out: the only
// files read are the results and the pictures that they name.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// A measured value with its interval; no interval where it was measured once.
struct Estimate {
  double mean = 0;
  std::optional<double> low, high;
};

struct ReportScore {
  // "whole"; a band of eccentricity such as "0-2.6"; a retinal region; "weighted", by cortical magnification
  std::string part;
  std::optional<Estimate> value;
  bool is_resolved = true;  // false: under the floor, not told apart from the reference's own noise
};

struct ReportFrame {
  std::int32_t index = 0;
  double t_s = 0;                                       // video time
  std::optional<double> time_s;                         // what rendering it took
  std::string event;                                    // fixation, in-flight, blink, none
  std::optional<Vec2d> gaze_px;                         // gaze_true, continuous frame pixels
  std::vector<double> rings_px;                         // radii of region borders about the gaze
  std::string png;                                      // relative to the results; empty: none
  std::string flip_png;                                 // the same of its map of FLIP
  std::map<std::string, std::optional<double>> scores;  // metric -> over the whole frame
};

using ReportSettingsList = std::vector<std::pair<std::string, std::string>>;  // option -> value, in the file's order

// What somebody else printed for a setting.
struct ReportPublished {
  double speed_up = 0;  // t_uniform / t_foveated
  std::string source;
};

// One measured setting: a test row, or a baseline of the test row that `of` names.
struct ReportRow {
  std::string id, scene, gaze, role, of, label;
  std::string reference;                         // key of the reference it was measured against
  std::map<std::string, std::string> baselines;  // of a test row: role -> id
  ReportSettingsList settings;
  std::optional<Estimate> time_s;
  std::optional<double> samples, spp_mean, rays, peak_mib, efficiency;
  std::optional<Estimate> speed_up;  // t_uniform / t_foveated
  std::optional<double> end_to_end;  // the same with the output; none without pictures, or of an older sweep
  std::optional<Estimate> reached;   // of an equal-time row: its time over the test's
  std::map<std::string, std::vector<ReportScore>> scores;
  std::vector<ReportPublished> published;
  std::vector<ReportFrame> frames;
};

struct ReportMetric {
  std::string name, unit, note;
  bool is_lower_better = true;
};

// Metric -> part -> what the reference differs by from itself.
using ReportFloor = std::map<std::string, std::map<std::string, double>>;

struct ReportScene {
  std::string name, key;          // of a scene seen in several ways there are several, by their references' keys
  std::string reference_text;     // samples, seeds and scramblings in words
  std::string reference_pattern;  // of display pictures, relative to the results; empty: none
  ReportFloor floor;
  std::map<std::string, ReportFloor> floor_by_gaze;  // where bands make it differ
};

// Time in proportion to the reference's at a stated quality.
struct ReportFixedQuality {
  std::string metric, scene, gaze, curve, bound, why;  // bound: "", ">" or "<"
  std::optional<double> at, speed_up;
};

// Whether a metric saw that the gaze was wrong.
struct ReportControl {
  std::string scene, gaze, of, metric, wrong, why;
  std::optional<double> right_score, wrong_score;
  bool is_sensitive = false;
};

// results.json of `gazetrace sweep`, checked.
struct ReportData {
  std::string directory;  // of the results file; what paths are relative to
  std::string title, plan_file, methods;
  ReportSettingsList build, machine, viewing, color, common_settings;
  std::vector<std::string> varied;                                    // names of options
  std::vector<std::string> bands;                                     // names, from the gaze outwards
  std::map<std::string, std::vector<double>> band_pixel_share;        // gaze -> share of each band
  std::map<std::string, std::map<std::string, double>> event_shares;  // gaze -> what the eye did -> share of frames
  std::vector<ReportMetric> metrics;
  std::vector<ReportScene> scenes;
  std::vector<ReportRow> rows;
  // metric -> "scene/gaze" -> row ids; "scene/gaze/reference" where several references share the place
  std::map<std::string, std::map<std::string, std::vector<std::string>>> pareto;
  std::vector<ReportFixedQuality> fixed_quality;
  std::vector<ReportControl> controls;
  std::vector<std::string> notes;
};

// A results file, or a folder with results.json. Error(input) with the place in the file for what is missing or of the
// wrong kind; scores may be null.
ReportData read_results(const std::string& path);

// A diagram that stands on its own, with the numbers that it shows.
struct ReportPlot {
  std::string kind;  // "pareto", "bands", "time"
  std::string scene, gaze, metric;
  std::string row;   // id of the test row; empty for "pareto", which shows all of a scene and gaze
  std::string name;  // file name without suffix, distinct
  std::string title;
  std::string svg, csv;
};
std::vector<ReportPlot> report_plots(const ReportData& data);

// In words, from the numbers. Two values differ where their intervals do not overlap.
struct ReportFindings {
  std::vector<std::string> summary;  // a sentence or two for each test row
  std::string tally;                 // how many comparisons with baselines of the same cost came out how
  std::vector<std::string> losses;   // where a baseline is better or faster
  std::vector<std::string> caveats;  // what the measurements cannot say
};
ReportFindings report_findings(const ReportData& data);

// A paragraph with every setting, to be pasted into a paper.
std::string report_methods(const ReportData& data);

// A row for each run, metric and part.
std::string report_csv(const ReportData& data);

struct ReportSettings {
  double max_mib = 24;  // of the page; pictures are reduced, then left out, to stay below
  int threads = 0;
};

// The page: one file without anything outside it. Pictures that cannot be read become warnings.
struct ReportPage {
  std::string html;
  Warnings warnings;
};
ReportPage report_page(const ReportData& data, const ReportSettings& settings);

}  // namespace gazetrace
