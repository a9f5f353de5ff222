// SPDX-License-Identifier: Apache-2.0
#include "pipeline/timing_row.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

void add_trace(const TraceStats& stats, TimingRow& row) {
  add_counts(stats, row);
  for (const RegionTraceStats& region : stats.regions) {
    row.trace_cpu_ms += static_cast<double>(region.cpu_ns) * 1e-6;
  }
}

}  // namespace

TimingRow timing_row(const FrameRequest& request) {
  TimingRow row;
  row.frame = request.frame;
  row.pixels = static_cast<std::uint64_t>(request.width_px) * static_cast<std::uint64_t>(request.height_px);
  const GazeAtTime& gaze = request.gaze_render;
  row.gaze = gaze_numbers(request);
  row.gaze_state = to_string(gaze.state);
  row.gaze_event = gaze.movement ? to_string(*gaze.movement) : "none";
  const bool has_row = gaze.row_before != 0 || gaze.row_after != 0;
  row.gaze_age_ms = !has_row            ? ""
                    : gaze.age_is_known ? fmt::format("{:.3f}", static_cast<double>(gaze.age_ns) * 1e-6)
                                        : "unknown";
  if (request.gaze_effective_age_ns) {
    row.gaze_effective_age_ms = fmt::format("{:.3f}", static_cast<double>(*request.gaze_effective_age_ns) * 1e-6);
  }
  row.no_gaze = gaze.no_gaze ? 1 : 0;
  return row;
}

TimingRow lost_timing_row(const FrameRequest& request, std::optional<double> exposure_ev) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  TimingRow row = timing_row(request);
  for (double* ms : {&row.plan_ms, &row.guiding_ms, &row.pilot_ms, &row.trace_ms, &row.guides_ms, &row.reconstruct_ms,
                     &row.temporal_ms, &row.exposure_ms, &row.layers_ms, &row.color_ms, &row.write_ms, &row.total_ms,
                     &row.trace_cpu_ms, &row.peak_memory_mib}) {
    *ms = kUnknown;
  }
  row.region_cpu_ms.fill(kUnknown);
  row.exposure_ev = exposure_ev.value_or(kUnknown);
  return row;
}

void add_prediction(const Prediction& prediction, TimingRow& row) {
  const auto text = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.6g}", *value) : std::string();
  };
  if (prediction.relmse) {
    row.predicted_relmse = text(prediction.relmse);
  }
  if (prediction.jod) {
    row.predicted_jod = text(prediction.jod);
  }
}

void add_pilot(const TraceStats& pilot, TimingRow& row) {
  add_trace(pilot, row);
  row.pilot_samples += pilot.samples;
}

void add_others(const TraceStats& others, TimingRow& row) {
  add_trace(others, row);
  row.other_samples += others.samples;
}

void add_samples(const TraceStats& samples, const TraceStats& pilot, const SamplingMap& map, TimingRow& row) {
  add_trace(samples, row);
  add_pilot(pilot, row);
  const std::vector<std::string>& names = timing_regions();
  for (std::size_t i = 0; i < map.regions.size(); ++i) {
    const auto name = std::find(names.begin(), names.end(), map.regions[i].name);
    if (name != names.end()) {
      const auto column = static_cast<std::size_t>(name - names.begin());
      row.region_pixels.at(column) += map.regions[i].pixels;
      row.region_samples.at(column) += samples.regions[i].samples;
      row.region_cpu_ms.at(column) += static_cast<double>(samples.regions[i].cpu_ns) * 1e-6;
    }
  }
}

}  // namespace gazetrace
