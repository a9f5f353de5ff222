// SPDX-License-Identifier: Apache-2.0
// Many settings rendered and compared against one certified reference: what each costs in time and what it costs in
// quality, beside the uniform rendering that makes a claim honest.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/compare.hpp"
#include "gazetrace/pipeline.hpp"

namespace gazetrace {

using NamedValues = std::vector<std::pair<std::string, std::string>>;

enum class SweepRole : std::uint8_t {
  test,
  uniform_reference_rate,  // the full rate everywhere
  equal_samples,           // uniform with the test's samples
  equal_time,              // uniform with the test's time
  low_resolution,          // uniform at the full rate on so few pixels that samples are equal, upscaled
  uniform_rate,            // of the ladder that fixed quality is interpolated on
  wrong_gaze,              // the test steered by a gaze that was not there
};
std::string to_string(SweepRole role);  // "test", "uniform-reference-rate", ...

struct SweepScene {
  std::string name;
  std::string description;                             // its settings, for the paragraph on methods
  std::function<std::shared_ptr<const Scene>()> load;  // called when the scene's turn comes
  TracerOptions tracer;
};

// What a group of tests is measured against. Its plan needs no gaze.
struct SweepReference {
  std::string key;        // of the tests that use it
  std::size_t scene = 0;  // in SweepPlan::scenes
  std::string digest;     // of everything that reaches into its pixels, seeds aside
  PipelineSettings pipeline;
  FramePlan plan;
  ColorSettings color;
  std::vector<std::uint64_t> seeds;  // one a scrambling; an even number, at least 4
};

// What somebody else printed for a setting.
struct SweepPublished {
  double speed_up = 0;  // t_uniform / t_foveated
  std::string source;
};

// A setting to be measured, ready to render. Outputs of `pipeline` are not heeded.
struct SweepTest {
  std::string id, gaze, label;
  std::size_t scene = 0;
  std::string reference;         // SweepReference::key
  NamedValues settings;          // what some row varies, with this row's values
  NamedValues uniform_settings;  // of these, what the uniform rows beside it share: neither sampling nor gaze
  PipelineSettings pipeline;
  FramePlan plan;
  double resolution_scale = 1;  // rendered at this part of the size, and upscaled
  std::vector<SweepPublished> published;
  std::string digest;          // of everything that reaches into its pixels, seed aside
  std::string uniform_digest;  // the same without sampling and gaze: of the uniform rows beside it
};

struct SweepBaselines {
  bool reference_rate = true, equal_samples = true, equal_time = true, low_resolution = true;
  bool wrong_gaze = true;
  std::vector<double> uniform_rates;  // samples a pixel, of further uniform rows
  std::uint32_t reference_spp = 32;   // the full rate
};

struct SweepMeasure {
  int repeats = 3;         // each with a seed of its own: settings' seed, +1, +2, ...
  int warm_up = 1;         // frames of each row that are rendered before the first round and thrown away
  double leave_out_s = 0;  // frames of this first part of a clip are rendered and seen by the metrics, but not scored
  ComparisonSettings comparison;  // view, frame rate and pixels per degree are those of each test
  SweepBaselines baselines;
  // Quality levels at which times are compared, by metric.
  std::vector<std::pair<std::string, double>> fixed_quality;
  bool write_png = true, write_exr = false;  // frames of the first repeat
  // Uniform samples a pixel of the run that a sample's cost by region is taken from; 0: no efficiency.
  std::uint32_t efficiency_spp = 4;
};

struct SweepPlan {
  std::string title, plan_file, directory;
  std::vector<SweepScene> scenes;
  std::vector<SweepReference> references;
  std::vector<SweepTest> tests;
  NamedValues gazes;  // name and settings, for the paragraph on methods
  SweepMeasure measure;
  bool restart = false;         // throws away what the directory holds of an earlier sweep
  NamedValues common_settings;  // what no row varies, all of it
  NamedValues stated_settings;  // of these what was chosen, and what decides light and sampling anyway
  std::vector<std::string> varied;
};

// The mean of repeats and its 95 % interval by Student's t; without bounds for a single one.
struct Interval {
  double mean = 0;
  std::optional<double> low, high;
};
double student_t_quantile(double probability, int degrees_of_freedom);  // probability in (0.5, 1)
Interval mean_interval(const std::vector<double>& values);
// Of what is above zero, such as times: the geometric mean, its interval by the logarithms.
Interval geometric_interval(const std::vector<double>& values);
// Of numerator / denominator, measured in pairs: the geometric mean of the pairs' ratios, its interval by the
// logarithms.
Interval ratio_interval(const std::vector<double>& numerator, const std::vector<double>& denominator);

// A point of a curve of quality over time.
struct QualityAtTime {
  double time_s = 0, quality = 0;
};
// Indices of the points that no other beats in both (or equals in one and beats in the other), in the order of time.
std::vector<std::size_t> pareto_front(const std::vector<QualityAtTime>& points, MetricDirection better);
// t_uniform / t_foveated at one quality. log t is interpolated linearly over quality between neighbours on the front of
// each curve, never extrapolated: where a curve does not reach the level, what is known is a bound.
struct FixedQuality {
  std::optional<double> speed_up;
  std::string bound;  // "": as it stands; ">", "<": no more is known
  std::string why;    // of a bound, or of none
};
FixedQuality speed_up_at_quality(const std::vector<QualityAtTime>& uniform, const std::vector<QualityAtTime>& foveated,
                                 MetricDirection better, double level);

// Which part of a clip a frame belongs to.
struct SweepFrame {
  std::int32_t frame = 1;
  std::int64_t t_video_ns = 0;
  // "fixation", "in-flight" (saccade and 100 ms after), "blink", "unclassified", "none" (no gaze); "start": left out
  std::string event;
  std::optional<Vec2d> gaze_px;  // gaze_true
  std::vector<double> rings_px;  // where regions end about it, by their angles in the middle of the view
};

// "whole", "weighted" and the names of bands.
using ScoreParts = std::map<std::string, double>;
using ScoreTable = std::map<std::string, ScoreParts>;  // by metric

struct SweepFrameRun {
  double time_s = 0;
  ScoreTable scores;  // "whole" only
};
// One rendering of all frames of a row.
struct SweepRun {
  double time_s = 0;  // a frame, mean: plan, trace, guides, reconstruct, temporal, upscaling
  // A frame, mean: exposure, view and the files of its picture. Of the repeat whose pictures are kept; else unknown.
  std::optional<double> output_s;
  double samples = 0, rays = 0, pixels = 0;  // of all frames
  double lost_samples = 0;                   // rejected rays and samples that were not finite
  double peak_mib = 0;  // of the process while the frames were rendered: with the scene, the metrics' state and what
                        // the row's earlier frames have freed, if the program keeps that
  double trace_reconstruct_ms = 0;  // of all frames
  std::map<std::string, double> region_samples;
  ScoreTable scores;  // over the scored frames
  std::vector<SweepFrameRun> frames;
};

struct SweepScore {
  Interval value;
  bool resolved = true;  // told from the reference's own error
};
struct SweepRow {
  std::string id, scene, gaze, label;
  SweepRole role = SweepRole::test;
  std::string of;                                // the (first) test that it stands beside; empty: none
  std::string curve;                             // rows of one scene, gaze and curve share all but their sampling
  std::string wrong;                             // wrong_gaze: "shuffled", "center", "mirrored"
  std::map<std::string, std::string> baselines;  // of tests: role -> id
  NamedValues settings;
  bool is_foveated = false;     // its samples follow a gaze
  double resolution_scale = 1;  // rendered at this part of the size, and upscaled
  std::string reference;
  std::vector<SweepFrame> frames;
  double compared_pixels = 0;  // of all frames
  std::vector<SweepPublished> published;
  std::string png;             // pattern relative to the directory; empty: none
  std::vector<SweepRun> runs;  // by repeat
  // Of the runs:
  Interval time_s, speed_up, reached;  // reached: equal_time over the test's
  // As speed_up, of times that the first repeat's output_s is added to; empty where no pictures were written. Reading
  // the scene, which is done once for a sequence, is in neither.
  std::optional<double> end_to_end;
  std::optional<double> efficiency;
  std::map<std::string, std::map<std::string, SweepScore>> scores;  // metric -> part
};

// The error of the reference: its first half of scramblings against the second. The difference of the halves has twice
// the standard deviation of their mean's own error, so that this is a careful floor: what scores better is not told
// from a perfect picture. Squared errors of a test contain the reference's variance, which is a quarter of the halves'
// mean squared difference; it is taken off mse, rmse and relmse.
struct SweepFloor {
  std::string gaze;
  ScoreTable scores;
  // What this gaze looks at in the reference's frames.
  std::vector<double> band_pixel_share;        // by band of eccentricity; empty without gaze
  std::map<std::string, double> event_shares;  // SweepFrame::event -> share of the frames
};
struct SweepReferenceResult {
  std::string scene, key, directory, png;  // relative
  double spp = 0;
  std::size_t pictures = 0;  // frames that were rendered: 1 where neither camera nor scene moves
  std::vector<std::uint64_t> seeds;
  std::vector<SweepFloor> floors;
};

// `curve`: what its foveated rows share of what the plan varies, "region-blocks 1;1"; rates of samples are the curve.
struct SweepFixedQuality {
  std::string metric, scene, gaze, curve;
  double at = 0;
  FixedQuality result;
};
struct SweepControl {
  std::string scene, gaze, metric, wrong, of;
  Interval right, wrong_score;
  bool sensitive = false;
  std::string why;
};

struct SweepResults {
  std::string build, machine;
  int threads = 0;
  std::vector<SweepRow> rows;
  std::vector<SweepReferenceResult> references;
  // metric -> "scene/gaze" -> ids; "scene/gaze/reference" where several references share the place: scores against
  // different references do not compare.
  std::map<std::string, std::map<std::string, std::vector<std::string>>> pareto;
  std::vector<SweepFixedQuality> fixed_quality;
  std::vector<SweepControl> controls;
  std::vector<std::string> notes;
};

struct SweepObserver {
  std::function<void(const std::string& line)> tell;  // what is being done, for a person; may be empty
};

// A sweep's directory, locked as long as this lives or its process does: two sweeps at once would spoil each other's
// times. Error(input) where another process has it.
class SweepDirectory {
 public:
  explicit SweepDirectory(const std::string& path);
  ~SweepDirectory();
  SweepDirectory(SweepDirectory&& other) noexcept;
  SweepDirectory& operator=(SweepDirectory&&) = delete;
  SweepDirectory(const SweepDirectory&) = delete;
  SweepDirectory& operator=(const SweepDirectory&) = delete;

 private:
  int lock_ = -1;
};

// Error(usage, input) for what contradicts itself, and where the directory holds work of another build or machine:
// times and pictures of two builds are never mixed. To be called before anything is rendered; makes the directory.
[[nodiscard]] SweepDirectory prepare_sweep(const SweepPlan& plan);
// Error(usage) where a metric cannot score this test, or nothing of it would be scored; tells it from sizes and rates
// alone, before anything is rendered.
void check_scoring(const SweepMeasure& measure, const SweepTest& test);
// Renders what is not yet finished in the directory, in rounds over all rows of a scene, and puts together the tables.
SweepResults run_sweep(const SweepPlan& plan, const SweepObserver& observer);

// Rows that the plan will measure and the camera samples that they take, without rendering; the search for the rate of
// equal time and what warms up are left out. Loads a scene that is seen from one place in several frames: whether its
// reference is one picture or many depends on what moves in it.
struct SweepEstimate {
  struct Row {
    std::string id, label, role;
    double samples = 0;  // one repeat, all frames that are rendered
    int repeats = 0;
  };
  std::vector<Row> rows;
  double samples = 0;  // of everything
};
SweepEstimate estimate_sweep(const SweepPlan& plan);

std::string sweep_json(const SweepPlan& plan, const SweepResults& results);
std::string sweep_csv(const SweepPlan& plan, const SweepResults& results);
std::string sweep_table(const SweepPlan& plan, const SweepResults& results);
// Every setting in a paragraph, ready to paste.
std::string sweep_methods(const SweepPlan& plan, const SweepResults& results);

}  // namespace gazetrace
