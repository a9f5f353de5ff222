// SPDX-License-Identifier: Apache-2.0
// Renders many settings and compares them with one certified reference: the cost of each in time and its quality,
// beside the uniform renderings without which a claim would not be honest.
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
  std::string description;                             // its settings in words, for the paragraph on methods
  std::function<std::shared_ptr<const Scene>()> load;  // called when the sweep comes to the scene
  TracerOptions tracer;
};

// The reference that a group of tests is measured against. Its plan needs no gaze.
struct SweepReference {
  std::string key;        // as in SweepTest::reference
  std::size_t scene = 0;  // index into SweepPlan::scenes
  std::string digest;     // of everything that its pixels depend on except the seeds
  PipelineSettings pipeline;
  FramePlan plan;
  ColorSettings color;
  std::vector<std::uint64_t> seeds;  // one for each scrambling: an even number, at least 4
  // Rendered again with more samples, until its noise moves a score at the highest level in JOD by less than 0.1 or it
  // has so many samples a pixel; empty: with as many as `pipeline` says.
  std::optional<double> most_spp;
};

// A setting to be measured, ready to render. The outputs of `pipeline` are ignored.
struct SweepTest {
  std::string id, gaze, label;
  std::size_t scene = 0;
  std::string reference;         // SweepReference::key
  NamedValues settings;          // every option that some row varies, with the values of this row
  NamedValues uniform_settings;  // those that the uniform rows beside it share: without sampling and gaze
  PipelineSettings pipeline;
  FramePlan plan;
  double resolution_scale = 1;  // rendered at this fraction of the size, and scaled up
  std::vector<PublishedSpeedUp> published;
  std::string digest;          // of everything that its pixels depend on except the seed
  std::string uniform_digest;  // the same without sampling and gaze, for the uniform rows beside it
};

struct SweepBaselines {
  bool reference_rate = true, equal_samples = true, equal_time = true, low_resolution = true;
  bool wrong_gaze = true;
  std::vector<double> uniform_rates;  // samples per pixel of further uniform rows
  std::uint32_t reference_spp = 32;   // the full rate
};

struct SweepMeasure {
  int repeats = 3;         // each with its own seed: that of the settings, +1, +2, ...
  int warm_up = 1;         // frames of each row that are rendered before the first round, unmeasured
  double leave_out_s = 0;  // frames of this first part of a clip are rendered and shown to the metrics, but not scored
  ComparisonSettings comparison;  // view, frame rate and pixels per degree are replaced by those of each test
  SweepBaselines baselines;
  // The levels of quality at which times are compared: metric and level.
  std::vector<std::pair<std::string, double>> fixed_quality;
  bool write_png = true, write_exr = false;  // pictures of the first repeat
  // Samples per pixel of the run that measures the cost of a sample in each region; 0: no efficiency is measured.
  std::uint32_t efficiency_spp = 4;
};

struct SweepPlan {
  std::string title, plan_file, directory;
  std::vector<SweepScene> scenes;
  std::vector<SweepReference> references;
  std::vector<SweepTest> tests;
  NamedValues gazes;  // names and settings in words, for the paragraph on methods
  SweepMeasure measure;
  bool restart = false;         // deletes an earlier sweep in the directory
  bool go_on = false;           // measures although a reference is known too badly for the levels that are asked for
  bool trust_files = false;     // does not compare existing pictures with their digests
  NamedValues common_settings;  // all options that no row varies
  NamedValues stated_settings;  // those of them that were chosen, or that decide light and sampling
  std::vector<std::string> varied;
  std::vector<std::string> files;  // that its jobs read
};

// Of Student's distribution of t, for a probability in (0.5, 1).
double student_t_quantile(double probability, int degrees_of_freedom);
// The mean of repeats with its interval; NaN of no values.
Interval mean_interval(const std::vector<double>& values);
// Of errors, which are never below 0: the mean with bounds by the logarithm of the mean, whose standard error is that
// of the mean over the mean. Without bounds where the mean is not above 0.
Interval error_interval(const std::vector<double>& values);
// For values above zero, such as times: the geometric mean, with the interval of the mean of their logarithms.
Interval geometric_interval(const std::vector<double>& values);
// For numerator / denominator, measured in pairs: the geometric_interval() of the ratios of the pairs.
Interval ratio_interval(const std::vector<double>& numerator, const std::vector<double>& denominator);

// A point of a curve of quality over time.
struct QualityAtTime {
  double time_s = 0, quality = 0;
};
// The Pareto front, as indices in the order of time: the points that no other point equals in time or quality and beats
// in the other, or beats in both.
std::vector<std::size_t> pareto_front(const std::vector<QualityAtTime>& points, MetricDirection better);
// t_uniform / t_foveated at one quality. log t is interpolated linearly over quality between neighbours on the front of
// each curve, and never extrapolated: where a curve does not reach the level, there is only a bound.
FixedQuality speed_up_at_quality(const std::vector<QualityAtTime>& uniform, const std::vector<QualityAtTime>& foveated,
                                 MetricDirection better, double level);

struct SweepObserver {
  std::function<void(const std::string& line)> tell;  // a line on the current work, for a person; may be empty
  std::function<void(const std::string& line)> warn;  // of files that are damaged, and made again; may be empty
  // As PipelineObserver::stop_before_frame and TraceSettings::stop. The row, or the picture of a reference, that is in
  // hand is then given up with Error(interrupted); finished work stays.
  std::function<bool(double frame_ms)> stop_before_frame;
  std::function<bool()> stop_now;
};

// One of several processes, on any machines, that measure a sweep together, each some of its rows.
struct SweepTask {
  std::uint32_t number = 1, count = 1;      // the first is 1
  [[nodiscard]] std::string label() const;  // "2/5"
};

// The directory of a sweep, locked as long as this object and its process live: two sweeps at once would spoil each
// other's times. Tasks of one sweep may share a directory, each number once. Error(input) where another process has
// locked it.
class SweepDirectory {
 public:
  SweepDirectory(const std::string& path, const std::optional<SweepTask>& task);
  ~SweepDirectory();
  SweepDirectory(SweepDirectory&& other) noexcept;
  SweepDirectory& operator=(SweepDirectory&&) = delete;
  SweepDirectory(const SweepDirectory&) = delete;
  SweepDirectory& operator=(const SweepDirectory&) = delete;

 private:
  struct Locks;
  std::unique_ptr<Locks> locks_;
};

// Makes and locks the directory; to be called before run_sweep(), or run_sweep_task(). Error(usage) for a plan without
// tests, Error(input) where the directory cannot be made, or holds work of another build or machine: times and pictures
// of two builds are never mixed. Files that have changed since they were written, by the digests of records and
// pictures, are removed with a warning, and will be made again.
[[nodiscard]] SweepDirectory prepare_sweep(const SweepPlan& plan, const std::optional<SweepTask>& task = std::nullopt,
                                           const SweepObserver& observer = {});
// Error(usage) where a metric cannot score this test, or no frame of it would be scored. It needs only sizes and rates,
// so that it can be called before anything is rendered.
void check_scoring(const SweepMeasure& measure, const SweepTest& test);
// Renders the unfinished rows in the directory, in rounds over all rows of a scene, and returns the
// results.
Results run_sweep(const SweepPlan& plan, const SweepObserver& observer);

// The rows of one task: their ids, and the samples of these rows and of their baselines, with an allowance
// for each pixel.
struct SweepShare {
  std::vector<std::string> rows;
  double samples = 0;
};
// By predicted cost alone, so that every task finds the same. Rows that show the same pixels are of one task, and so
// are a test and the rows of its samples and its time.
std::vector<SweepShare> divide_sweep(const SweepPlan& plan, std::uint32_t count);
// The same for the rows of one task, which stay in the directory for merge_sweep(). Tasks that share a directory share
// the work on its references, too: each renders pictures that no other is at. Error(nothing_to_do) for a task without
// rows.
void run_sweep_task(const SweepPlan& plan, const SweepTask& task, const SweepObserver& observer);
// The results of all tasks, as run_sweep() would have them but for the times. Nothing is rendered. The contents of
// `folders` are taken into the plan's directory before, which is made and locked. Error(input) for folders of another
// build, and where rows or references are not finished, or were, and are damaged since.
Results merge_sweep(const SweepPlan& plan, const std::vector<std::string>& folders, const SweepObserver& observer = {});

// The rows that the plan will measure and the camera samples that they take, without rendering. The search for the rate
// of equal time and the warm-up are not counted. A scene that is seen from one place in several frames is loaded,
// because its reference is one picture only if nothing in it moves.
struct SweepEstimate {
  struct Row {
    std::string id, label, role;
    double samples = 0;  // of one repeat, over all frames that are rendered
    int repeats = 0;
  };
  std::vector<Row> rows;
  double samples = 0;  // of everything
};
SweepEstimate estimate_sweep(const SweepPlan& plan);

}  // namespace gazetrace
