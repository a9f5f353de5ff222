// SPDX-License-Identifier: Apache-2.0
// The order of things: for each scene its references, then rounds over all rows.
//   first round   tests -> what a sample costs by region -> baselines, those of equal samples included
//                 -> the rates of equal time, found by measuring -> those rows
//   other rounds  every row once, forwards and backwards in turn, so that a machine that grows slower or faster does so
//                 for all of them
// Whatever has been finished is in a file, and is not done again.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <map>
#include <set>

#include "compare/eccentricity_bands.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "sweep/conclude.hpp"
#include "sweep/measure.hpp"
#include "sweep/reference.hpp"
#include "sweep/rows.hpp"
#include "sweep/scorer.hpp"
#include "sweep/state.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastSpp = 1.0 / 64;

std::string digest_of_reference(const SweepReference& reference) {
  return digest_settings(
      {{"reference", reference.digest}, {"seeds", fmt::format("{}", fmt::join(reference.seeds, " "))}});
}

class SceneSweep {
 public:
  SceneSweep(const SweepPlan& plan, std::size_t scene, Measurements& measured, const SweepObserver& observer)
      : plan_(plan), scene_(scene), measured_(measured), observer_(observer) {}

  void run() {
    plan_rows();
    if (rows_.empty()) {
      return;
    }
    const std::shared_ptr<const Scene> scene = plan_.scenes[scene_].load();
    PathTracer tracer(*scene, plan_.scenes[scene_].tracer);
    tracer_ = &tracer;
    prepare_references(*scene);
    first_round();
    for (int repeat = 1; repeat < plan_.measure.repeats; ++repeat) {
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        measure(repeat % 2 == 1 ? rows_.size() - 1 - i : i, repeat);
      }
    }
    tracer_ = nullptr;
    hand_over();
  }

 private:
  void tell(const std::string& line) const {
    if (observer_.tell) {
      observer_.tell(line);
    }
  }

  // Adds a row unless there is one with the same pixels, gaze and reference, and returns the id of the row that is
  // there. Every test has its own row of equal time, whose time is compared with that of the test.
  std::string add(PlannedRow row) {
    for (const PlannedRow& other : rows_) {
      if (row.row.role != RowRole::equal_time && other.digest == row.digest && other.row.gaze == row.row.gaze &&
          other.row.reference == row.row.reference) {
        return other.row.id;
      }
    }
    rows_.push_back(std::move(row));
    return rows_.back().row.id;
  }
  void add_baselines(std::size_t test, std::vector<PlannedRow> rows) {
    for (PlannedRow& row : rows) {
      const RowRole role = row.row.role;
      const std::string id = add(std::move(row));
      if (role != RowRole::wrong_gaze && role != RowRole::uniform_rate) {
        rows_[test].row.baselines[to_string(role)] = id;
      }
    }
  }

  void plan_rows() {
    for (std::size_t t = 0; t < plan_.tests.size(); ++t) {
      if (plan_.tests[t].scene == scene_) {
        rows_.push_back(test_row(plan_, t));
      }
    }
    tests_ = rows_.size();
    for (std::size_t t = 0; t < tests_; ++t) {
      add_baselines(t, baselines_known_before(plan_, rows_[t], measured_.notes));
    }
  }

  void prepare_references(const Scene& scene) {
    for (const SweepReference& reference : plan_.references) {
      if (reference.scene == scene_) {
        references_.emplace(reference.key, &reference);
        colors_.emplace(reference.key, ColorPipeline(reference.color));
        certified_.emplace(reference.key, ensure_reference(*tracer_, scene, reference, colors_.at(reference.key),
                                                           plan_.directory, observer_));
      }
    }
  }

  // All rows that show the same pixels as this one, itself among them, in the order of the rows.
  [[nodiscard]] std::vector<const PlannedRow*> sharing(const PlannedRow& row) const {
    std::vector<const PlannedRow*> rows;
    for (const PlannedRow& other : rows_) {
      if (other.digest == row.digest && other.row.reference == row.row.reference) {
        rows.push_back(&other);
      }
    }
    return rows;
  }

  // A key from what these rows show, how they are scored and what their time depends on. The same work has the same key
  // in a longer plan, unless that plan has further rows with these pixels.
  [[nodiscard]] std::string key_of(const std::vector<const PlannedRow*>& rows) const {
    NamedValues parts{{"pixels", rows.front()->digest},
                      {"reference", digest_of_reference(*references_.at(rows.front()->row.reference))},
                      {"seed", std::to_string(rows.front()->pipeline.trace.seed)},
                      {"threads", std::to_string(resolve_threads(rows.front()->pipeline.threads))},
                      {"bvh", std::to_string(static_cast<int>(plan_.scenes[scene_].tracer.bvh_quality))},
                      {"warm-up", std::to_string(plan_.measure.warm_up)}};
    for (const PlannedRow* row : rows) {
      parts.emplace_back("scores " + row->row.gaze, scoring_digest(plan_.measure, row->row.frames));
    }
    return digest_settings(parts).substr(0, 16);
  }
  [[nodiscard]] std::string path_of(const std::string& kind, const std::string& key) const {
    return fmt::format("{}/runs/{}-{}.json", plan_.directory, kind, key);
  }

  void warm_up(const PlannedRow& row) {
    if (plan_.measure.warm_up > 0 && warm_.insert(row.digest).second) {
      time_row(*tracer_, colors_.at(row.row.reference), row, 0, static_cast<std::size_t>(plan_.measure.warm_up));
    }
  }

  void measure(std::size_t index, int repeat) {
    PlannedRow& row = rows_[index];
    const std::vector<const PlannedRow*> rows = sharing(row);
    const std::string key = key_of(rows);
    const std::string path = path_of("run", fmt::format("{}-{}", key, repeat + 1));
    std::optional<StoredRun> stored = load_run(path);
    if (!stored) {
      warm_up(row);
      const std::string& reference = row.row.reference;
      stored = measure_rows({*tracer_, colors_.at(reference), certified_.at(reference)}, rows, repeat, plan_.measure,
                            plan_.directory, "frames/" + key);
      save_run(path, *stored);
      tell(fmt::format("round {} of {}: {} {}/{} {}: {:.4g} s a frame", repeat + 1, plan_.measure.repeats, row.row.id,
                       row.row.scene, row.row.gaze, row.row.label, stored->by_gaze.at(row.row.gaze).time_s));
    }
    row.row.runs.push_back(stored->by_gaze.at(row.row.gaze));
    if (!stored->png.empty()) {
      row.row.png = stored->png;
    }
  }

  void first_round() {
    for (std::size_t t = 0; t < tests_; ++t) {
      measure(t, 0);
      measure_costs(t);
    }
    for (std::size_t t = 0; t < tests_; ++t) {
      const PlannedRow& test = rows_[t];
      const double pixels = static_cast<double>(test.size.width_px) * test.size.height_px;
      const double spp = test.row.runs.front().samples / (pixels * static_cast<double>(test.plan.frames.size()));
      add_baselines(t, baselines_of_samples(plan_, test, spp));
    }
    for (std::size_t i = tests_; i < rows_.size(); ++i) {
      measure(i, 0);
    }
    const std::size_t before = rows_.size();
    for (std::size_t t = 0; t < tests_; ++t) {
      if (plan_.measure.baselines.equal_time && is_foveated(plan_.tests[rows_[t].test])) {
        add_baselines(t, {equal_time_row(t)});
      }
    }
    for (std::size_t i = before; i < rows_.size(); ++i) {
      measure(i, 0);
    }
  }

  void measure_costs(std::size_t test) {
    const std::optional<PlannedRow> row = cost_row(plan_, rows_[test]);
    if (!row) {
      return;
    }
    const std::string path = path_of("cost", key_of({&*row}));
    std::optional<StoredRun> stored = load_run(path);
    if (!stored) {
      stored = time_row(*tracer_, colors_.at(row->row.reference), *row, 0);
      save_run(path, *stored);
    }
    costs_[test] = *stored;
  }

  PlannedRow equal_time_row(std::size_t test) {
    const PlannedRow& of = rows_[test];
    const std::string path = path_of("equal-time", key_of({&of}));
    std::optional<RateSearch> search = load_rate(path);
    if (!search) {
      std::vector<std::pair<double, double>> known;
      for (const PlannedRow& row : rows_) {
        const bool same = row.uniform == of.uniform && row.row.reference == of.row.reference &&
                          row.row.gaze == of.row.gaze && !row.row.runs.empty();
        const bool is_uniform = row.row.role == RowRole::equal_samples || row.row.role == RowRole::uniform_rate ||
                                row.row.role == RowRole::uniform_reference_rate;
        if (same && is_uniform) {
          const SweepRun& run = row.row.runs.front();
          known.emplace_back(run.samples / run.pixels, run.time_s);
        }
      }
      search = find_rate(of.row.runs.front().time_s, known, kLeastSpp, 4.0 * plan_.measure.baselines.reference_spp,
                         [&](double spp) {
                           const PlannedRow row = uniform_row(plan_, of, RowRole::equal_time, spp);
                           const StoredRun run = time_row(*tracer_, colors_.at(row.row.reference), row, 0);
                           return run.by_gaze.begin()->second.time_s;
                         });
      save_rate(path, *search);
      tell(fmt::format("{}: equal time at {:.4g} samples a pixel, {} rates tried", of.row.id, search->spp,
                       search->tried.size()));
    }
    return uniform_row(plan_, of, RowRole::equal_time, search->spp);
  }

  // Expected over measured time. The expected time is that of the samples of each region at what a sample costs there
  // when all regions have the same rate.
  [[nodiscard]] std::optional<double> efficiency_of(std::size_t test) const {
    const auto found = costs_.find(test);
    if (found == costs_.end() || !(found->second.trace_cpu_ms > 0)) {
      return std::nullopt;
    }
    const StoredRun& cost = found->second;
    const std::map<std::string, double>& samples_of = cost.by_gaze.begin()->second.region_samples;
    double sum = 0;
    for (const SweepRun& run : rows_[test].row.runs) {
      double expected_ms = 0;
      for (const auto& [region, samples] : run.region_samples) {
        const auto of_region = samples_of.find(region);
        if (of_region == samples_of.end() || !(of_region->second > 0)) {
          return std::nullopt;
        }
        expected_ms += samples * cost.region_cpu_ms.at(region) / of_region->second;
      }
      sum += expected_ms * cost.trace_ms / cost.trace_cpu_ms / run.trace_reconstruct_ms;
    }
    return sum / static_cast<double>(rows_[test].row.runs.size());
  }

  // Hands over the references with the floor of every gaze, then the rows.
  void hand_over() {
    for (const auto& [key, reference] : references_) {
      const CertifiedReference& certified = certified_.at(key);
      ResultReference result;
      result.scene = plan_.scenes[scene_].name;
      result.key = key;
      result.directory = reference_folder(*reference);
      result.png = result.directory + "/reference.####.png";
      result.spp = certified.spp;
      result.pictures = certified.pictures;
      result.seeds = reference->seeds;
      std::set<std::string> done;
      for (const PlannedRow& row : rows_) {
        if (row.row.reference == key && done.insert(row.row.gaze).second) {
          const FramePlan& plan = plan_.tests[row.test].plan;
          const std::string digest = digest_settings({{"reference", digest_of_reference(*reference)},
                                                      {"scores", scoring_digest(plan_.measure, row.row.frames)}});
          const ComparisonSettings comparison =
              comparison_of(plan_.measure.comparison, plan, row.row.frames, row.pipeline.fps);
          result.floors.push_back({row.row.gaze,
                                   ensure_floor(certified, colors_.at(key), comparison, row.row.frames, digest),
                                   band_shares(row.row, plan), event_shares(row.row.frames)});
        }
      }
      measured_.references.push_back(std::move(result));
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (i < tests_) {
        rows_[i].row.efficiency = efficiency_of(i);
      }
      measured_.rows.push_back(std::move(rows_[i].row));
    }
  }

  // The share of the pixels in each band of eccentricity, over the frames with gaze; empty without any.
  [[nodiscard]] std::vector<double> band_shares(const MeasuredRow& row, const FramePlan& plan) const {
    std::vector<double> shares(kEccentricityBandsDeg.size());
    double pixels = 0;
    for (std::size_t f = 0; f < row.frames.size(); ++f) {
      if (row.frames[f].gaze_px) {
        const EccentricityBands bands =
            eccentricity_bands(plan.frames[f].view, *row.frames[f].gaze_px, plan_.measure.comparison.regions,
                               plan_.measure.comparison.metric.threads);
        for (const std::uint8_t band : bands.band.pixels) {
          shares[band] += 1;
        }
        pixels += static_cast<double>(bands.band.pixels.size());
      }
    }
    if (pixels == 0) {
      return {};
    }
    for (double& share : shares) {
      share /= pixels;
    }
    return shares;
  }

  const SweepPlan& plan_;
  std::size_t scene_;
  Measurements& measured_;
  const SweepObserver& observer_;
  std::deque<PlannedRow> rows_;  // tests first; a row keeps its address when others are added
  std::size_t tests_ = 0;
  PathTracer* tracer_ = nullptr;
  std::map<std::string, const SweepReference*> references_;
  std::map<std::string, ColorPipeline> colors_;
  std::map<std::string, CertifiedReference> certified_;
  std::map<std::size_t, StoredRun> costs_;
  std::set<std::string> warm_;
};

}  // namespace

SweepDirectory prepare_sweep(const SweepPlan& plan) {
  if (plan.tests.empty()) {
    throw Error(ErrorKind::usage, plan.plan_file, "there is nothing to measure", "give a [[setting]] or a [grid]");
  }
  std::error_code problem;
  std::filesystem::create_directories(plan.directory, problem);
  if (!std::filesystem::is_directory(plan.directory)) {
    throw Error(ErrorKind::input, plan.directory, "the folder cannot be made: " + problem.message(),
                "choose another `output` folder");
  }
  SweepDirectory directory(plan.directory);
  if (plan.restart) {
    clear_directory(plan.directory);
  }
  claim_directory(plan.directory);
  return directory;
}

Results run_sweep(const SweepPlan& plan, const SweepObserver& observer) {
  Measurements measured;
  for (std::size_t scene = 0; scene < plan.scenes.size(); ++scene) {
    SceneSweep(plan, scene, measured, observer).run();
  }
  Results results = conclude(facts_of_plan(plan), plan, measured);
  results.methods = sweep_methods(plan, results);
  return results;
}

}  // namespace gazetrace
