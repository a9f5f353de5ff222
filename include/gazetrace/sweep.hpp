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
#include "gazetrace/results.hpp"

namespace gazetrace {

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
  std::vector<PublishedSpeedUp> published;
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

// Of Student's distribution of t, for a probability in (0.5, 1).
double student_t_quantile(double probability, int degrees_of_freedom);
// The mean of repeats.
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
// each curve, and never extrapolated: where a curve does not reach the level, what is known is a bound.
FixedQuality speed_up_at_quality(const std::vector<QualityAtTime>& uniform, const std::vector<QualityAtTime>& foveated,
                                 MetricDirection better, double level);

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
Results run_sweep(const SweepPlan& plan, const SweepObserver& observer);

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

}  // namespace gazetrace
