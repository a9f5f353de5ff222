// SPDX-License-Identifier: Apache-2.0
// The order of things: for each scene its references, then rounds over all rows.
//   first round   tests -> what a sample costs by region -> baselines, those of equal samples included
//                 -> the rates of equal time, found by measuring -> those rows
//   other rounds  every row once, forwards and backwards in turn, so that a machine that grows slower or faster does so
//                 for all of them
// Whatever has been finished is in a file, and is not done again. A task of several goes the same way over its own rows
// alone, and a merge over all of them, finding everything finished.
#include "sweep/scene_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "compare/eccentricity_bands.hpp"
#include "core/parallel.hpp"
#include "sweep/certainty.hpp"
#include "sweep/measure.hpp"
#include "sweep/reference.hpp"
#include "sweep/scene_rows.hpp"
#include "sweep/scorer.hpp"
#include "sweep/shares.hpp"
#include "sweep/state.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastSpp = 1.0 / 64;

std::string digest_of_reference(const SweepReference& reference) {
  return digest_settings(
      {{"reference", reference.digest}, {"seeds", fmt::format("{}", fmt::join(reference.seeds, " "))}});
}

// A reference of its own, with so many samples in each scrambling.
SweepReference with_samples(const SweepReference& planned, double each_spp) {
  SweepReference reference = planned;
  const std::string spp = fmt::format("{:.0f}", each_spp);
  reference.key += "-" + spp;
  reference.digest = digest_settings({{"reference", planned.digest}, {"spp", spp}});
  reference.pipeline.foveation.spp = each_spp;
  return reference;
}

class SceneSweep {
 public:
  SceneSweep(const SweepPlan& plan, std::size_t scene, Scope& scope, Measurements& measured,
             const SweepObserver& observer)
      : plan_(plan),
        scene_(scene),
        scope_(scope),
        measured_(measured),
        observer_(observer),
        rows_(plan, scene, measured.notes) {
    for (const PlannedRow& row : rows_) {
      if (scope.kind == Scope::Kind::task && !scope.rows.contains(deciding_row(rows_, row).row.id)) {
        of_others_.insert(&row);
      }
    }
  }

  void run() {
    if (of_others_.size() == rows_.size()) {
      return;
    }
    if (scope_.kind == Scope::Kind::merge) {
      find_references();
      if (!scope_.missing.empty()) {
        return;
      }
      measure_all();
      if (scope_.missing.empty()) {
        hand_over();
      }
      return;
    }
    const std::shared_ptr<const Scene> scene = plan_.scenes[scene_].load();
    PathTracer tracer(*scene, plan_.scenes[scene_].tracer);
    tracer_ = &tracer;
    prepare_references(*scene);
    measure_all();
    tracer_ = nullptr;
    if (scope_.kind == Scope::Kind::whole) {
      hand_over();
    }
  }

 private:
  void tell(const std::string& line) const {
    if (observer_.tell) {
      observer_.tell(line);
    }
  }

  [[nodiscard]] bool is_mine(const PlannedRow& row) const { return !of_others_.contains(&row); }

  [[nodiscard]] bool is_reference_of_mine(const SweepReference& reference) const {
    return reference.scene == scene_ && std::any_of(rows_.begin(), rows_.end(), [&](const PlannedRow& row) {
             return is_mine(row) && row.row.reference == reference.key;
           });
  }

  void prepare_references(const Scene& scene) {
    for (const SweepReference& planned : plan_.references) {
      if (is_reference_of_mine(planned)) {
        settle(planned, [&](const SweepReference& reference) {
          return std::optional(ensure_reference(*tracer_, scene, reference, colors_.at(planned.key), plan_.directory,
                                                scope_.kind == Scope::Kind::task, observer_));
        });
      }
    }
  }

  void find_references() {
    std::shared_ptr<const Scene> scene;
    for (const SweepReference& planned : plan_.references) {
      if (!is_reference_of_mine(planned)) {
        continue;
      }
      settle(planned, [&](const SweepReference& reference) {
        std::optional<CertifiedReference> certified = finished_reference(reference, plan_.directory);
        if (!certified) {
          scope_.missing.push_back("reference " + reference.key);
          return certified;
        }
        certified->pictures = reference.plan.frames.size();
        if (scene_decides_pictures(reference)) {
          scene = scene ? scene : plan_.scenes[scene_].load();
          certified->pictures = reference_pictures(reference, *scene).size();
        }
        return certified;
      });
    }
  }

  // Takes a reference once it is known well enough or has as many samples as it may have, and says how well that is.
  // `make` renders or finds it. Every process that is at the same sweep comes to the same number of samples.
  template <class Make>
  void settle(const SweepReference& planned, const Make& make) {
    colors_.emplace(planned.key, ColorPipeline(planned.color));
    const auto scramblings = static_cast<double>(planned.seeds.size());
    std::optional<double> each_spp = planned.pipeline.foveation.spp;
    for (;;) {
      const SweepReference reference = planned.most_spp ? with_samples(planned, *each_spp) : planned;
      const std::optional<CertifiedReference> certified = make(reference);
      if (!certified) {
        return;
      }
      std::vector<ResultFloor> floors = floors_of(planned.key, reference, *certified);
      const std::string known = known_to(plan_.measure, floors);
      tell(fmt::format("reference {}: {:.0f} samples a pixel{}{}", reference.key, certified->spp,
                       known.empty() ? "" : "; its halves differ by ", known));
      const std::optional<double> more =
          planned.most_spp ? next_samples(plan_.measure, floors, certified->spp, *planned.most_spp) : std::nullopt;
      if (more) {
        each_spp = std::ceil(*more / scramblings);
        continue;
      }
      if (scope_.kind != Scope::Kind::merge) {
        check_levels(plan_, reference, floors, certified->spp);
      }
      references_.emplace(planned.key, reference);
      certified_.emplace(planned.key, *certified);
      floors_.emplace(planned.key, std::move(floors));
      return;
    }
  }

  // Those of the gazes whose rows are measured here.
  [[nodiscard]] std::vector<ResultFloor> floors_of(const std::string& key, const SweepReference& reference,
                                                   const CertifiedReference& certified) const {
    std::vector<ResultFloor> floors;
    std::set<std::string> done;
    for (const PlannedRow& row : rows_) {
      if (row.row.reference != key || !is_mine(row) || !done.insert(row.row.gaze).second) {
        continue;
      }
      const FramePlan& plan = plan_.tests[row.test].plan;
      const std::string digest = digest_settings(
          {{"reference", digest_of_reference(reference)}, {"scores", scoring_digest(plan_.measure, row.row.frames)}});
      const ComparisonSettings comparison =
          comparison_of(plan_.measure.comparison, plan, row.row.frames, row.pipeline.fps);
      floors.push_back({row.row.gaze, ensure_floor(certified, colors_.at(key), comparison, row.row.frames, digest),
                        band_shares(row.row, plan), event_shares(row.row.frames)});
    }
    return floors;
  }

  void measure_all() {
    first_round();
    for (int repeat = 1; repeat < plan_.measure.repeats; ++repeat) {
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        measure(repeat % 2 == 1 ? rows_.size() - 1 - i : i, repeat);
      }
    }
  }

  // The rows that show the same pixels as this one, and are rendered with it.
  [[nodiscard]] std::vector<const PlannedRow*> rendered_with(const PlannedRow& row) const {
    std::vector<const PlannedRow*> rows = rows_.sharing(row);
    std::erase_if(rows, [&](const PlannedRow* other) { return !is_mine(*other); });
    return rows;
  }

  // A key from what these rows show, how they are scored and what their time depends on. The same work has the same key
  // in a longer plan, unless that plan has further rows with these pixels.
  [[nodiscard]] std::string key_of(const std::vector<const PlannedRow*>& rows) const {
    NamedValues parts{{"pixels", rows.front()->digest},
                      {"reference", digest_of_reference(references_.at(rows.front()->row.reference))},
                      {"seed", std::to_string(rows.front()->pipeline.trace.seed)},
                      {"threads", threads_in_key(*rows.front())},
                      {"warm-up", std::to_string(plan_.measure.warm_up)}};
    for (const PlannedRow* row : rows) {
      parts.emplace_back("scores " + row->row.gaze, scoring_digest(plan_.measure, row->row.frames));
    }
    return digest_settings(parts).substr(0, 16);
  }
  // What tasks have measured on machines of different sizes is found by whoever joins it.
  [[nodiscard]] std::string threads_in_key(const PlannedRow& row) const {
    return scope_.kind == Scope::Kind::whole ? std::to_string(resolve_threads(row.pipeline.threads)) : "of a task";
  }
  [[nodiscard]] std::string path_of(const std::string& kind, const std::string& key) const {
    return fmt::format("{}/runs/{}-{}.json", plan_.directory, kind, key);
  }
  // A row that a task has measured is found by itself, since nobody knows which others were rendered with it.
  [[nodiscard]] std::string path_of_row(const PlannedRow& row, int repeat) const {
    return path_of("row", fmt::format("{}-{}", key_of({&row}), repeat + 1));
  }

  void warm_up(const PlannedRow& row) {
    if (plan_.measure.warm_up > 0 && warm_.insert(row.digest).second) {
      time_row(*tracer_, colors_.at(row.row.reference), row, 0, observer_,
               static_cast<std::size_t>(plan_.measure.warm_up));
    }
  }

  // Renders the row with those that show the same pixels, and keeps what was measured.
  StoredRun render(const PlannedRow& row, const std::vector<const PlannedRow*>& rows, const std::string& key,
                   int repeat) {
    warm_up(row);
    const std::string& reference = row.row.reference;
    StoredRun stored = measure_rows({*tracer_, colors_.at(reference), certified_.at(reference), observer_}, rows,
                                    repeat, plan_.measure, plan_.directory, "frames/" + key);
    if (scope_.kind == Scope::Kind::task) {
      stored.task = scope_.label;
      stored.machine = machine_description();
      for (const PlannedRow* one : rows) {
        save_run(path_of_row(*one, repeat), stored);
      }
    } else {
      save_run(path_of("run", fmt::format("{}-{}", key, repeat + 1)), stored);
    }
    tell(fmt::format("round {} of {}: {} {}/{} {}: {:.4g} s a frame", repeat + 1, plan_.measure.repeats, row.row.id,
                     row.row.scene, row.row.gaze, row.row.label, stored.by_gaze.at(row.row.gaze).time_s));
    return stored;
  }

  void measure(std::size_t index, int repeat) {
    PlannedRow& row = rows_[index];
    if (!is_mine(row)) {
      return;
    }
    const std::vector<const PlannedRow*> rows = rendered_with(row);
    const std::string key = key_of(rows);
    std::optional<StoredRun> stored =
        load_run(scope_.kind == Scope::Kind::whole ? path_of("run", fmt::format("{}-{}", key, repeat + 1))
                                                   : path_of_row(row, repeat));
    if (!stored && scope_.kind == Scope::Kind::merge) {
      if (repeat == 0 || !row.row.runs.empty()) {  // else it is named already
        scope_.missing.push_back(fmt::format("{} (round {})", row.row.id, repeat + 1));
      }
      return;
    }
    if (!stored) {
      stored = render(row, rows, key, repeat);
    }
    row.row.runs.push_back(stored->by_gaze.at(row.row.gaze));
    if (!stored->png.empty()) {
      row.row.png = stored->png;
    }
    if (!stored->task.empty()) {
      row.row.task = stored->task;
      measured_.machines[stored->task] = stored->machine;
    }
  }

  // A merge that misses a test's measurements does not know what follows from them.
  [[nodiscard]] bool is_measured(std::size_t test) const { return !rows_[test].row.runs.empty(); }

  void first_round() {
    for (std::size_t t = 0; t < rows_.tests(); ++t) {
      measure(t, 0);
      if (is_measured(t)) {
        measure_costs(t);
      }
    }
    for (std::size_t t = 0; t < rows_.tests(); ++t) {
      const PlannedRow& test = rows_[t];
      if (is_measured(t)) {
        const double pixels = static_cast<double>(test.size.width_px) * test.size.height_px;
        const double spp = test.row.runs.front().samples / (pixels * static_cast<double>(test.plan.frames.size()));
        rows_.add_baselines(t, baselines_of_samples(plan_, test, spp));
      }
    }
    for (std::size_t i = rows_.tests(); i < rows_.size(); ++i) {
      measure(i, 0);
    }
    const std::size_t before = rows_.size();
    for (std::size_t t = 0; t < rows_.tests(); ++t) {
      if (is_measured(t) && plan_.measure.baselines.equal_time && is_foveated(plan_.tests[rows_[t].test])) {
        add_equal_time_row(t);
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
    if (!stored && scope_.kind == Scope::Kind::merge) {
      scope_.missing.push_back(rows_[test].row.id + " (costs by region)");
      return;
    }
    if (!stored) {
      stored = time_row(*tracer_, colors_.at(row->row.reference), *row, 0, observer_);
      save_run(path, *stored);
    }
    costs_[test] = *stored;
  }

  void add_equal_time_row(std::size_t test) {
    const PlannedRow& of = rows_[test];
    const std::string path = path_of("equal-time", key_of({&of}));
    std::optional<RateSearch> search = load_rate(path);
    if (!search && scope_.kind == Scope::Kind::merge) {
      scope_.missing.push_back(of.row.id + " (equal time)");
      return;
    }
    if (!search) {
      search = search_equal_time(of);
      save_rate(path, *search);
      tell(fmt::format("{}: equal time at {:.4g} samples a pixel, {} rates tried", of.row.id, search->spp,
                       search->tried.size()));
    }
    rows_.add_baselines(test, {uniform_row(plan_, of, RowRole::equal_time, search->spp)});
  }

  RateSearch search_equal_time(const PlannedRow& of) {
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
    return find_rate(of.row.runs.front().time_s, known, kLeastSpp, 4.0 * plan_.measure.baselines.reference_spp,
                     [&](double spp) {
                       const PlannedRow row = uniform_row(plan_, of, RowRole::equal_time, spp);
                       const StoredRun run = time_row(*tracer_, colors_.at(row.row.reference), row, 0, observer_);
                       return run.by_gaze.begin()->second.time_s;
                     });
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
      result.directory = reference_folder(reference);
      result.png = result.directory + "/reference.####.png";
      result.spp = certified.spp;
      result.pictures = certified.pictures;
      result.seeds = reference.seeds;
      result.floors = floors_.at(key);
      measured_.references.push_back(std::move(result));
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (i < rows_.tests()) {
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
  Scope& scope_;
  Measurements& measured_;
  const SweepObserver& observer_;
  SceneRows rows_;
  std::set<const PlannedRow*> of_others_;  // of a task: rows that it does not measure
  PathTracer* tracer_ = nullptr;
  std::map<std::string, SweepReference> references_;  // as they were rendered
  std::map<std::string, ColorPipeline> colors_;
  std::map<std::string, CertifiedReference> certified_;
  std::map<std::string, std::vector<ResultFloor>> floors_;
  std::map<std::size_t, StoredRun> costs_;
  std::set<std::string> warm_;
};

}  // namespace

void measure_scenes(const SweepPlan& plan, Scope& scope, Measurements& measured, const SweepObserver& observer) {
  for (std::size_t scene = 0; scene < plan.scenes.size(); ++scene) {
    SceneSweep(plan, scene, scope, measured, observer).run();
  }
}

}  // namespace gazetrace
