// SPDX-License-Identifier: Apache-2.0
// The measurements of a sweep. There is one model: `sweep` fills it, results.json holds it, and tables, pages and
// diagrams are made from it. Values that do not exist or are not finite are null in the file, and empty after reading.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

using NamedValues = std::vector<std::pair<std::string, std::string>>;

// A measured value and its 95 % interval by Student's t over the repeats; without bounds where it was measured once.
struct Interval {
  double mean = 0;
  std::optional<double> low, high;
};

// The purpose of a row.
enum class RowRole : std::uint8_t {
  test,                    // a setting that the plan asks for
  uniform_reference_rate,  // the full rate everywhere
  equal_samples,           // uniform with the test's samples
  equal_time,              // uniform with the test's time
  low_resolution,          // uniform at the full rate on as many fewer pixels as give equal samples, scaled up
  uniform_rate,            // uniform at one of the rates between which fixed quality is interpolated
  wrong_gaze,              // the test steered by a gaze that was not there
};
std::string to_string(RowRole role);  // "test", "uniform-reference-rate", ...
std::optional<RowRole> row_role(const std::string& name);

// Parts of the picture are named "whole"; by bands of eccentricity such as "0-2.6", in degrees; by retinal regions such
// as "fovea"; and "weighted", by cortical magnification.
using ScoreParts = std::map<std::string, double>;
using ScoreTable = std::map<std::string, ScoreParts>;  // by metric

struct ResultScore {
  std::optional<Interval> value;
  bool is_resolved = true;  // false: better than the reference differs from itself, so not told apart from its noise
};

// One frame of a row, in the order of video time.
struct ResultFrame {
  std::int32_t index = 1;  // the number in the names of its pictures
  double t_s = 0;          // video time
  // The eye movement: "fixation", "in-flight" (a saccade and the 100 ms after it), "blink", "unclassified" or "none"
  // (there is no gaze). "start" marks frames of the first part of the clip that is not scored.
  std::string event = "none";
  std::optional<Vec2d> gaze_px;                         // gaze_true, in continuous frame pixels
  std::vector<double> rings_px;                         // radii of region borders about it, in the middle of the view
  std::optional<double> time_s;                         // time of rendering it, mean over the repeats
  std::string png, flip_png;                            // pictures, relative to the results; empty: none
  std::map<std::string, std::optional<double>> scores;  // by metric, of the whole frame in the first repeat
};

// The published speed-up of a setting.
struct PublishedSpeedUp {
  double speed_up = 0;  // t_uniform / t_foveated
  std::string source;
};

// One measured setting: a test, or a row that stands beside a test. Times are seconds a frame, of plan, guiding,
// pilot, trace, guides, reconstruct, temporal and upscaling.
struct ResultRow {
  std::string id, scene, gaze, label;
  RowRole role = RowRole::test;
  std::string of;                                // the (first) test that it stands beside; empty: none
  std::string curve;                             // rows of one scene, gaze and curve share all but their sampling
  std::string wrong;                             // of wrong_gaze: "shuffled", "center", "mirrored"
  std::map<std::string, std::string> baselines;  // of tests: role -> id
  NamedValues settings;                          // every option that some row varies, with the values of this row
  double resolution_scale = 1;                   // rendered at this fraction of the size, and scaled up
  std::string reference;                         // key of the reference that it was measured against
  std::string task;                              // in which its times were taken, such as "2/5"; empty: one process
  std::optional<Interval> time_s;                // geometric mean over the repeats
  std::vector<double> times_s;                   // by repeat; NaN where the file has null
  // Exposure, view and writing of a frame's picture, in the first repeat; unknown where no pictures were written.
  std::optional<double> output_s;
  std::optional<double> samples, spp_mean, rays, peak_mib;  // of all frames, means over the repeats
  std::optional<Interval> speed_up;                         // t_uniform / t_foveated at the reference rate
  std::optional<double> end_to_end;                         // the same ratio of times that include output_s
  std::optional<double> efficiency;                         // expected over measured time
  std::vector<PublishedSpeedUp> published;
  std::optional<Interval> reached;                                   // of equal_time: its time over that of the test
  std::map<std::string, std::map<std::string, ResultScore>> scores;  // by metric and part
  std::vector<ResultFrame> frames;
};

// By how much the reference differs from itself in the frames in which a gaze is scored, and the object of that gaze.
struct ResultFloor {
  std::string gaze;  // empty: of rows without gaze, or of every gaze in a file that does not tell them apart
  ScoreTable scores;
  std::vector<double> band_pixel_share;        // share of the pixels by band of eccentricity; empty without gaze
  std::map<std::string, double> event_shares;  // ResultFrame::event -> share of the frames
};

// A reference is the mean of independent scramblings, and its error is the score of the first half of them against the
// second. The difference of the halves has twice the standard deviation of the error of their mean, so that this is a
// careful floor: a better score is not told apart from that of a perfect picture. Squared errors of a test contain the
// variance of the reference, a quarter of the halves' mean squared difference; it is taken off mse, rmse and relmse.
struct ResultReference {
  std::string scene, key;      // a scene that is seen in several ways has several references, told apart by the key
  std::string directory, png;  // relative to the results; png is a pattern such as "reference.####.png", or empty
  std::optional<double> spp;   // samples per pixel of all scramblings together
  std::size_t pictures = 0;    // frames that were rendered: 1 where neither camera nor scene moves
  std::vector<std::uint64_t> seeds;  // one for each scrambling
  std::vector<ResultFloor> floors;
};

struct ResultMetric {
  std::string name, unit, note;
  bool is_lower_better = true;
};

// t_uniform / t_foveated at one quality.
struct FixedQuality {
  std::optional<double> speed_up;
  std::string bound;  // "": as it stands; ">", "<": no more is known
  std::string why;    // why it is a bound, or why there is none
};
// A curve holds rows that differ only in their rates of samples. `curve` names the other varied options that its
// foveated rows have in common, such as "region-blocks 1;1".
struct ResultFixedQuality {
  std::string metric, scene, gaze, curve;
  double at = 0;
  FixedQuality result;
  // Of a level in JOD: the saving of sampling by eccentricity alone by model_gain.hpp, for white noise.
  std::optional<double> model_gain = std::nullopt;
};

// Whether a metric noticed that the gaze was wrong.
struct ResultControl {
  std::string scene, gaze, of, metric, wrong, why;  // the metric is followed by the part if that is not the whole frame
  std::optional<double> right_score, wrong_score;
  bool is_sensitive = false;
};

struct ResultBuild {
  std::string version, digest, compiler, march;
};
struct ResultMachine {
  std::string cpu;
  std::optional<int> threads;
};
struct ResultViewing {
  std::vector<int> size_px;  // width and height; empty: not known
  std::optional<double> pixels_per_degree, width_deg, peak_cd_m2, contrast, ambient_lux;
  // The saving of sampling by eccentricity alone here by model_gain.hpp, at 9.5 JOD, with the gaze of the first test's
  // first frame: for white noise, and with its variance below 4 cycles a degree cut tenfold.
  std::optional<double> model_gain, model_gain_cut_4_cpd;
};

struct Results {
  std::string directory;  // folder of the file they were read from, which paths are relative to
  std::string title, plan_file;
  ResultBuild build;
  ResultMachine machine;
  ResultViewing viewing;
  std::string view;                 // the view through which pictures were shown and scored
  NamedValues common_settings;      // the options that no row varies
  std::vector<std::string> varied;  // the names of the options that rows vary
  int repeats = 0;                  // 0: not known
  std::vector<double> bands_deg;    // where bands of eccentricity begin, from the gaze outwards
  std::vector<double> regions_deg;  // where the fovea and the intermediate region of the scores end
  // For each gaze of which every reference says the same.
  std::map<std::string, std::vector<double>> band_pixel_share;
  std::map<std::string, std::map<std::string, double>> event_shares;
  std::vector<ResultMetric> metrics;  // in the plan's order
  std::vector<ResultReference> references;
  std::vector<ResultRow> rows;
  // metric -> "scene/gaze" -> ids; "scene/gaze/reference" where several references share the place: scores against
  // different references do not compare.
  std::map<std::string, std::map<std::string, std::vector<std::string>>> pareto;
  std::vector<ResultFixedQuality> fixed_quality;
  std::vector<ResultControl> controls;
  std::vector<std::string> notes;
  std::string methods;  // a paragraph with every setting; if empty, results_methods() makes a plainer one
};

// The text of results.json. Both directions follow one description of the fields. The file carries
// its version as its "format".
std::string results_json(const Results& results);
// A results file, or a folder with results.json. Error(input) for a file of another version, and with the place in the
// file for missing values and those of the wrong kind.
Results read_results(const std::string& path);

// A line for each row, metric and part of the picture; a line without scores for a row that has none.
std::string results_csv(const Results& results);
// The text on the terminal.
std::string results_table(const Results& results);
// A paragraph with every setting, to be pasted into a paper.
std::string results_methods(const Results& results);
// results.json, results.csv and methods.txt in a folder that is there; replaces them.
void write_results(const std::string& folder, const Results& results);

}  // namespace gazetrace
