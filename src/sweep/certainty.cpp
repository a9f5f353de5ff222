// SPDX-License-Identifier: Apache-2.0
// A score of noise is a power of its variance, which falls as 1 / samples. The halves of a reference differ by four
// times the variance of the whole.
#include "sweep/certainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/error.hpp"
#include "sweep/scorer.hpp"

namespace gazetrace {
namespace {

constexpr const char* kJod = "fovvideovdp";
constexpr double kBestJod = 10;
constexpr double kMostMoved_jod = 0.1;
constexpr double kVarianceOfHalves = 4;
// What is lacking to 10 JOD falls with this power of the samples: 0.41 to 0.72 between uniform rates of three scenes
// (examples/fixed-jod.md), the less the farther from 10.
constexpr double kJodPower = 0.6;

// A score as an error that is 0 where there is none, and that error's power of the noise's variance.
struct ErrorLaw {
  double error = 0, power = 1;
};
ErrorLaw error_law(const std::string& metric, double score) {
  if (metric == kJod) {
    return {kBestJod - score, kJodPower};
  }
  if (metric == "psnr") {
    return {std::pow(10, -score / 10), 1};
  }
  if (metric == "ssim") {
    return {1 - score, 1};
  }
  return {score, is_squared_error(metric) ? 1.0 : 0.5};
}

std::vector<double> levels_of(const SweepMeasure& measure, const std::string& metric) {
  std::vector<double> levels;
  for (const auto& [of, level] : measure.fixed_quality) {
    if (of == metric) {
      levels.push_back(level);
    }
  }
  return levels;
}

std::vector<std::string> metrics_with_levels(const SweepMeasure& measure) {
  std::vector<std::string> metrics;
  for (const auto& [metric, level] : measure.fixed_quality) {
    if (std::find(metrics.begin(), metrics.end(), metric) == metrics.end()) {
      metrics.push_back(metric);
    }
  }
  return metrics;
}

std::optional<double> whole_score(const ResultFloor& floor, const std::string& metric) {
  const auto parts = floor.scores.find(metric);
  if (parts == floor.scores.end() || !parts->second.contains("whole")) {
    return std::nullopt;
  }
  return parts->second.at("whole");
}

// Two digits are as many as the estimate has.
double rounded_up(double samples) {
  const double unit = std::pow(10, std::max(0.0, std::floor(std::log10(samples)) - 1));
  return std::ceil(samples / unit) * unit;
}

}  // namespace

double moved_jod(double floor_jod, double level_jod) {
  const ErrorLaw floor = error_law(kJod, floor_jod);
  const double error = kBestJod - level_jod;
  const double variance = std::pow(std::max(floor.error, 0.0), 1 / floor.power) / kVarianceOfHalves;
  return std::pow(std::pow(error, 1 / floor.power) + variance, floor.power) - error;
}

double samples_needed(const std::string& metric, double floor, double level, double spp) {
  const ErrorLaw law = error_law(metric, floor);
  double allowed = error_law(metric, level).error;
  double variance_parts = 1;
  if (metric == kJod) {
    const double moved = std::pow(allowed + kMostMoved_jod, 1 / law.power) - std::pow(allowed, 1 / law.power);
    allowed = std::pow(moved, law.power);
    variance_parts = kVarianceOfHalves;
  }
  return spp * std::pow(std::max(law.error, 0.0) / allowed, 1 / law.power) / variance_parts;
}

std::optional<double> highest_jod(const SweepMeasure& measure) {
  const std::vector<double> levels = levels_of(measure, kJod);
  return levels.empty() ? std::nullopt : std::optional(*std::max_element(levels.begin(), levels.end()));
}

std::optional<double> lowest_jod(const std::vector<ResultFloor>& floors) {
  std::optional<double> lowest;
  for (const ResultFloor& floor : floors) {
    if (const auto score = whole_score(floor, kJod)) {
      lowest = std::min(lowest.value_or(*score), *score);
    }
  }
  return lowest;
}

std::optional<double> next_samples(const SweepMeasure& measure, const std::vector<ResultFloor>& floors, double spp,
                                   double most_spp) {
  const std::optional<double> level = highest_jod(measure);
  const std::optional<double> floor = lowest_jod(floors);
  if (!level || !floor || spp >= most_spp || moved_jod(*floor, *level) < kMostMoved_jod) {
    return std::nullopt;
  }
  constexpr double kReserve = 1.2;  // the law is about right
  return std::min(most_spp, std::max(2 * spp, kReserve * samples_needed(kJod, *floor, *level, spp)));
}

std::string known_to(const SweepMeasure& measure, const std::vector<ResultFloor>& floors) {
  std::string text;
  for (const ResultFloor& floor : floors) {
    std::string scores;
    for (const std::string& metric : metrics_with_levels(measure)) {
      if (const auto score = whole_score(floor, metric)) {
        scores += fmt::format("{}{} {:.3g}", scores.empty() ? "" : ", ", metric, *score);
      }
    }
    if (!scores.empty()) {
      text += fmt::format("{}{} (gaze {})", text.empty() ? "" : "; ", scores, floor.gaze);
    }
  }
  return text;
}

void check_levels(const SweepPlan& plan, const SweepReference& reference, const std::vector<ResultFloor>& floors,
                  double spp) {
  if (plan.go_on) {
    return;
  }
  for (const ResultFloor& floor : floors) {
    for (const std::string& metric : metrics_with_levels(plan.measure)) {
      const std::optional<double> score = whole_score(floor, metric);
      const std::vector<double> levels = levels_of(plan.measure, metric);
      const bool tells_one = !score || std::any_of(levels.begin(), levels.end(),
                                                   [&](double level) { return !is_better(metric, level, *score); });
      if (tells_one) {
        continue;
      }
      double needed = 0;
      for (const double level : levels) {
        needed = std::max(needed, samples_needed(metric, *score, level, spp));
      }
      const std::size_t scramblings = reference.seeds.size();
      throw Error(
          ErrorKind::input, plan.plan_file,
          fmt::format("the reference of {} has {:.0f} samples a pixel and is known to {} {:.3g} (gaze {}): nothing "
                      "better can be told, and the levels are {:g}",
                      plan.scenes[reference.scene].name, spp, metric, *score, floor.gaze, fmt::join(levels, ", ")),
          fmt::format("about {:.0f} samples would do, which spp = {:.0f} in [reference] gives with its {} scramblings; "
                      "{}go-on = true there measures all the same",
                      rounded_up(needed), rounded_up(needed / static_cast<double>(scramblings)), scramblings,
                      metric == kJod ? "spp = \"auto\" finds them, and " : ""));
    }
  }
}

}  // namespace gazetrace
