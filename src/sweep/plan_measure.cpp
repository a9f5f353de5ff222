// SPDX-License-Identifier: Apache-2.0
#include "sweep/plan_measure.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/option_values.hpp"

namespace gazetrace {
namespace {

std::vector<double> uniform_rates(const SweepFile& file) {
  const std::string place = place_of(file, "uniform-rates");
  std::vector<double> rates;
  for (const std::string& text : file.measure.uniform_rates) {
    double spp = 0;
    parse_value(text, place + ": uniform-rates", spp);
    if (!(spp > 0 && spp <= 1e6)) {
      throw Error(ErrorKind::input, place, fmt::format("{} samples a pixel are no rate", text));
    }
    rates.push_back(spp);
  }
  return rates;
}

std::vector<std::pair<std::string, double>> fixed_quality(const SweepFile& file) {
  std::vector<std::string> wanted = file.measure.quality;
  if (wanted.empty()) {
    wanted = {"fovvideovdp=9", "fovvideovdp=9.5", "flip=0.05"};
  }
  const std::string place = place_of(file, "quality");
  std::vector<std::pair<std::string, double>> levels;
  for (const std::string& text : wanted) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      throw Error(ErrorKind::input, place, "'" + text + "' is not METRIC=VALUE", "write \"flip=0.05\"");
    }
    std::pair<std::string, double> level{text.substr(0, equals), 0};
    parse_value(text.substr(equals + 1), place + ": quality", level.second);
    if (is_among(file.measure.compare.metrics, level.first)) {
      levels.push_back(level);
    } else if (!file.measure.quality.empty()) {
      throw Error(ErrorKind::input, place, "metric '" + level.first + "' is not among those measured",
                  "add it to metrics");
    }
  }
  return levels;
}

}  // namespace

SweepMeasure sweep_measure(const SweepFile& file, const std::optional<int>& threads) {
  const SweepFileMeasure& from = file.measure;
  SweepMeasure measure;
  measure.repeats = from.repeats;
  measure.warm_up = from.warm_up;
  measure.leave_out_s = static_cast<double>(from.leave_out.ns) * 1e-9;
  measure.efficiency_spp = from.efficiency_spp;
  measure.comparison = from.compare.settings;
  measure.comparison.metrics = from.compare.metrics;
  measure.comparison.photometry.response = measure.comparison.metric.response;
  measure.comparison.metric.peak_cd_m2 = measure.comparison.photometry.peak_cd_m2;
  measure.comparison.original_border = !from.compare.correct_border;
  measure.comparison.metric.threads = threads.value_or(0);
  measure.write_png = from.pictures == "png" || from.pictures == "both";
  measure.write_exr = from.pictures == "exr" || from.pictures == "both";
  SweepBaselines& baselines = measure.baselines;
  baselines.reference_rate = is_among(from.baselines, "uniform-reference-rate");
  baselines.equal_samples = is_among(from.baselines, "equal-samples");
  baselines.equal_time = is_among(from.baselines, "equal-time");
  baselines.low_resolution = is_among(from.baselines, "low-resolution");
  baselines.wrong_gaze = from.controls;
  baselines.reference_spp = from.reference_rate;
  baselines.uniform_rates = uniform_rates(file);
  measure.fixed_quality = fixed_quality(file);
  return measure;
}

}  // namespace gazetrace
