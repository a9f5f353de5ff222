// SPDX-License-Identifier: Apache-2.0
#include "foveation_gain/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace::gain {
namespace {

void add_once(std::vector<std::string>& list, const std::string& name) {
  if (std::find(list.begin(), list.end(), name) == list.end()) {
    list.push_back(name);
  }
}

bool is_rival(const std::string& arm) {
  return arm == kLowResolution || arm == kInBlocks || arm == kPaper || arm == kFovealRate ||
         std::any_of(kUniformRates.begin(), kUniformRates.end(), [&](double rate) { return arm == uniform_arm(rate); });
}

std::string joined(const std::string& a, const std::string& b, const std::string& c, const std::string& d) {
  return a + '\n' + b + '\n' + c + '\n' + d;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

StageTimes median_of(const std::vector<Row>& rounds) {
  const auto of = [&](double StageTimes::*stage) {
    std::vector<double> values;
    values.reserve(rounds.size());
    for (const Row& row : rounds) {
      values.push_back(row.time.*stage);
    }
    return median(std::move(values));
  };
  return {of(&StageTimes::plan_ms), of(&StageTimes::guides_ms), of(&StageTimes::trace_ms),
          of(&StageTimes::reconstruct_ms), of(&StageTimes::temporal_ms)};
}

// Errors fall as powers of samples and of time; JOD is kept as it is.
double on_scale(Metric metric, double error) {
  return metric == Metric::jod ? error : std::log(error);
}
double off_scale(Metric metric, double value) {
  return metric == Metric::jod ? value : std::exp(value);
}

constexpr std::size_t index_of(Metric metric) {
  return static_cast<std::size_t>(metric);
}

}  // namespace

std::string verdict(const Comparison& comparison, Metric metric) {
  if (comparison.leaves == 0) {
    return "";
  }
  if (comparison.beneath_floor) {
    return "floor";
  }
  if (comparison.gazes < kFewestGazes) {
    return "few";
  }
  if (2 * comparison.continued > comparison.leaves) {
    return "beyond";
  }
  const double nothing = metric == Metric::relmse ? 1 : 0;
  constexpr double kRounding = 1e-7;  // of the rows' numbers
  const bool above = comparison.effect.low > nothing + kRounding;
  const bool below = comparison.effect.high < nothing - kRounding;
  return !above && !below ? "even" : above == (metric == Metric::jod) ? "wins" : "loses";
}

Results::Results(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    if (row.kind == "setup" || row.kind == "timed") {
      const std::string about = row.scene + (row.kind == "timed" ? ", times: " : ": ");
      for (const std::string& other : setups_) {
        if (other.rfind(about, 0) == 0 && other != about + row.arm) {
          throw Error(ErrorKind::usage, "--tables", "made in two ways: " + other + "; " + row.arm,
                      "give files of one view, frame, clip and budget a scene");
        }
      }
      add_once(setups_, about + row.arm);
    } else if (row.kind == "time") {
      times_[joined(row.scene, row.arm, row.filter, row.gaze)].push_back(row);
      add_once(timed_gazes_[joined(row.scene, row.arm, row.filter, "")], row.gaze);
    } else {
      add_once(scenes_, row.scene);
      add_once(gazes_[row.scene], row.gaze);
      rows_[joined(row.scene, row.gaze + '\n' + std::to_string(row.seed), row.arm, row.filter)] = row;
      if (row.kind == "score") {
        add_once(filters_, row.filter);
        seeds_ = std::max(seeds_, row.seed);
        if (!is_rival(row.arm)) {
          add_once(models_, row.arm);
        }
      }
    }
  }
}

std::size_t Results::gazes() const {
  std::size_t count = 0;
  for (const auto& [scene, gazes] : gazes_) {
    count += gazes.size();
  }
  return count;
}

const Row* Results::score(const Place& place, const std::string& arm, const std::string& filter) const {
  const auto found = rows_.find(joined(place.scene, place.gaze + '\n' + std::to_string(place.seed), arm, filter));
  return found == rows_.end() ? nullptr : &found->second;
}

std::optional<double> Results::error(const Place& place, const std::string& arm, const std::string& filter,
                                     Metric metric, std::size_t column) const {
  const Row* row = score(place, arm, filter);
  if (row == nullptr || !std::isfinite(row->score.at(index_of(metric)).at(column))) {
    return std::nullopt;
  }
  const double value = row->score.at(index_of(metric)).at(column);
  if (metric == Metric::relmse) {
    const Row* own = score({place.scene, place.gaze, 0}, "own", "none");
    const double noise = own == nullptr ? 0 : own->score.at(index_of(metric)).at(column);
    return std::max({value - noise, noise, 1e-30});  // never less than what was taken off
  }
  return metric == Metric::flip ? std::max(value, 1e-30) : value;
}

template <class PairAt>
Comparison Results::compare_pairs(Metric metric, std::size_t column, const std::string& only_scene,
                                  const PairAt& pair_at) const {
  Observations all;
  all.width = 4;  // effect, own, other, floor
  Comparison result;
  for (const std::string& scene : scenes_) {
    if (!only_scene.empty() && scene != only_scene) {
      continue;
    }
    all.add_scene();
    for (const std::string& gaze : gazes_.at(scene)) {
      all.add_gaze();
      const Row* halves = score({scene, gaze, 0}, "halves", "none");
      for (int seed = 1; seed <= seeds_; ++seed) {
        const std::optional<Pair> pair = pair_at(Place{scene, gaze, seed});
        if (!pair) {
          continue;
        }
        const double effect = metric == Metric::relmse ? std::log(pair->own / pair->other) : pair->own - pair->other;
        const double floor =
            halves == nullptr ? (metric == Metric::jod ? 10 : 0) : halves->score.at(index_of(metric)).at(column);
        all.add_leaf({effect, pair->own, pair->other, floor});
        result.continued += pair->continued ? 1 : 0;
      }
    }
  }
  all.prune();
  result.leaves = all.leaves();
  result.gazes = all.gazes();
  if (all.empty()) {
    return result;
  }
  const std::vector<double> mean = mean_of(all, [](std::size_t i, std::size_t) { return i; });
  result.own = mean[1];
  result.other = mean[2];
  result.beneath_floor =
      metric == Metric::jod ? std::max(mean[1], mean[2]) > mean[3] : std::min(mean[1], mean[2]) < mean[3];
  result.effect =
      bootstrap(all, [&](const std::vector<double>& m) { return metric == Metric::relmse ? std::exp(m[0]) : m[0]; });
  return result;
}

std::optional<double> Results::time_ms(const std::string& scene, const std::string& arm, const std::string& filter,
                                       const std::string& gaze, std::optional<double> spp) const {
  const auto exact = times_.find(joined(scene, arm, filter, gaze));
  if (exact != times_.end()) {
    return median_of(exact->second).sum_ms();
  }
  const auto timed = timed_gazes_.find(joined(scene, arm, filter, ""));
  if (timed == timed_gazes_.end()) {
    return std::nullopt;
  }
  double sum = 0;
  for (const std::string& other : timed->second) {
    const std::vector<Row>& rounds = times_.at(joined(scene, arm, filter, other));
    StageTimes time = median_of(rounds);
    time.trace_ms *= spp ? *spp / rounds[0].spp : 1;
    sum += time.sum_ms();
  }
  return sum / static_cast<double>(timed->second.size());
}

std::optional<Results::Pair> Results::at_equal_time(const Place& place, const std::string& model,
                                                    const std::string& filter, Metric metric,
                                                    std::size_t column) const {
  const Row* own = score(place, model, filter);
  const std::optional<double> own_error = error(place, model, filter, metric, column);
  if (!own_error) {
    return std::nullopt;
  }
  const std::optional<double> time = time_ms(place.scene, model, filter, place.gaze, own->spp);
  std::vector<std::pair<double, double>> curve;  // logarithm of the time, error on its scale
  for (const double rate : kUniformRates) {
    const std::optional<double> e = error(place, uniform_arm(rate), filter, metric, column);
    const std::optional<double> t = time_ms(place.scene, uniform_arm(rate), filter, kAnyGaze);
    if (e && t && (curve.empty() || std::log(*t) > curve.back().first)) {
      curve.emplace_back(std::log(*t), on_scale(metric, *e));
    }
  }
  if (!time || curve.size() < 2) {
    return std::nullopt;
  }
  const double at = std::log(*time);
  std::size_t right = 1;
  while (right + 1 < curve.size() && at > curve[right].first) {
    ++right;
  }
  const auto [t0, e0] = curve[right - 1];
  const auto [t1, e1] = curve[right];
  const double value = e0 + (e1 - e0) * (at - t0) / (t1 - t0);
  return Pair{*own_error, off_scale(metric, value), at < curve.front().first || at > curve.back().first};
}

Comparison Results::compare_arms(const std::string& arm, const std::string& other, const std::string& filter,
                                 Metric metric, std::size_t column, const std::string& scene) const {
  return compare_pairs(metric, column, scene, [&](const Place& place) -> std::optional<Pair> {
    const std::optional<double> a = error(place, arm, filter, metric, column);
    const std::optional<double> b = error(place, other, filter, metric, column);
    return a && b ? std::optional(Pair{*a, *b}) : std::nullopt;
  });
}

Comparison Results::compare(const std::string& model, const std::string& filter, Rival rival, Metric metric,
                            std::size_t column) const {
  switch (rival) {
    case Rival::equal_samples:
      return compare_arms(model, uniform_arm(1), filter, metric, column);
    case Rival::low_resolution:
      return compare_arms(model, kLowResolution, filter, metric, column);
    case Rival::in_blocks:
      return compare_arms(model, kInBlocks, filter, metric, column);
    case Rival::equal_time:
      break;
  }
  return compare_pairs(metric, column, "",
                       [&](const Place& place) { return at_equal_time(place, model, filter, metric, column); });
}

Interval Results::equal_rate(const std::string& model, const std::string& filter, Metric metric) const {
  Observations all;
  all.width = kUniformRates.size() + 1;
  for (const std::string& scene : scenes_) {
    all.add_scene();
    for (const std::string& gaze : gazes_.at(scene)) {
      all.add_gaze();
      for (int seed = 1; seed <= seeds_; ++seed) {
        std::vector<double> leaf;
        for (const double rate : kUniformRates) {
          if (const auto e = error({scene, gaze, seed}, uniform_arm(rate), filter, metric, 0)) {
            leaf.push_back(on_scale(metric, *e));
          }
        }
        if (const auto e = error({scene, gaze, seed}, model, filter, metric, 0)) {
          leaf.push_back(on_scale(metric, *e));
        }
        if (leaf.size() == all.width) {
          all.add_leaf(leaf);
        }
      }
    }
  }
  all.prune();
  return bootstrap(all, [&](std::vector<double> mean) {
    if (metric == Metric::jod) {
      std::transform(mean.begin(), mean.end(), mean.begin(), std::negate<>());
    }
    const double own = mean.back();
    if (own >= mean[0]) {
      return kUniformRates.front();
    }
    for (std::size_t r = 1; r < kUniformRates.size(); ++r) {
      if (own >= mean[r]) {
        const double share = (mean[r - 1] - own) / (mean[r - 1] - mean[r]);
        return kUniformRates.at(r - 1) * std::pow(kUniformRates.at(r) / kUniformRates.at(r - 1), share);
      }
    }
    return kUniformRates.back();
  });
}

double Results::sample_deviation() const {
  double most = 0;
  for (const auto& [key, row] : rows_) {
    const Place place{row.scene, row.gaze, row.seed};
    const Row* uniform = score(place, uniform_arm(1), row.filter);
    if (row.kind == "score" && uniform != nullptr && !is_rival(row.arm)) {
      most = std::max(most, std::abs(row.spp / uniform->spp - 1));
    }
  }
  return most;
}

double Results::mean_share(std::size_t column) const {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& [key, row] : rows_) {
    if (row.kind == "floor" && row.arm == "halves") {
      sum += row.share.at(column);
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

double Results::mean_floor(Metric metric, std::size_t column, const std::string& scene) const {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& [key, row] : rows_) {
    const double value = row.score.at(index_of(metric)).at(column);
    if (row.kind == "floor" && row.arm == "halves" && std::isfinite(value) && (scene.empty() || row.scene == scene)) {
      sum += value;
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

}  // namespace gazetrace::gain
