// SPDX-License-Identifier: Apache-2.0
#include "cli/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/progress.hpp"

namespace gazetrace {
namespace {

struct Stage {
  const char* name;
  double TimingRow::*ms;
};
constexpr std::array<Stage, 12> kStages{{{"plan", &TimingRow::plan_ms},
                                         {"guiding", &TimingRow::guiding_ms},
                                         {"pilot", &TimingRow::pilot_ms},
                                         {"trace", &TimingRow::trace_ms},
                                         {"guides", &TimingRow::guides_ms},
                                         {"reconstruct", &TimingRow::reconstruct_ms},
                                         {"temporal", &TimingRow::temporal_ms},
                                         {"exposure", &TimingRow::exposure_ms},
                                         {"layers", &TimingRow::layers_ms},
                                         {"color", &TimingRow::color_ms},
                                         {"write", &TimingRow::write_ms},
                                         {"total", &TimingRow::total_ms}}};

struct Totals {
  std::array<double, kStages.size()> ms{};
  std::uint64_t samples = 0, pilot_samples = 0, rays = 0, pixels = 0;
  double trace_ms = 0;
  double peak_memory_mib = 0;
};

Totals add_up(const SequenceResult& result) {
  Totals totals;
  for (const TimingRow& row : result.rows) {
    for (std::size_t i = 0; i < kStages.size(); ++i) {
      totals.ms[i] += row.*kStages[i].ms;
    }
    // A pilot's samples and rays are among those of the row, and were traced in its own time.
    totals.trace_ms += row.trace_ms + (row.pilot_samples > 0 ? row.pilot_ms : 0);
    totals.samples += row.samples;
    totals.pilot_samples += row.pilot_samples;
    totals.rays += row.rays_primary + row.rays_bounce + row.rays_shadow;
    totals.pixels += row.pixels;
    totals.peak_memory_mib = std::max(totals.peak_memory_mib, row.peak_memory_mib);
  }
  return totals;
}

double per(double value, double divisor) {
  return divisor > 0 ? value / divisor : 0.0;
}

}  // namespace

std::string summary_text(const SequenceResult& result, double wall_s) {
  const Totals totals = add_up(result);
  std::string text = fmt::format("{} frames in {}", result.rows.size(), duration_text(wall_s));
  if (!result.skipped.empty()) {
    text += fmt::format(", {} kept from before", result.skipped.size());
  }
  if (result.rows.empty()) {
    return text + "\n";
  }
  const auto frames = static_cast<double>(result.rows.size());
  text += "\nmean ms a frame:";
  for (std::size_t i = 0; i < kStages.size(); ++i) {
    text += fmt::format("{} {} {:.1f}", i == 0 ? "" : ",", kStages[i].name, totals.ms[i] / frames);
  }
  const double trace_s = totals.trace_ms * 1e-3;
  const auto pixels = static_cast<double>(totals.pixels);
  for (const auto& [name, fact] : result.facts) {
    text += fmt::format("\n{}: {}", name, fact);
  }
  text +=
      fmt::format("\n{:.3f} samples a pixel", per(static_cast<double>(totals.samples - totals.pilot_samples), pixels));
  if (totals.pilot_samples > 0) {
    text += fmt::format(" and {:.3f} of pilots", per(static_cast<double>(totals.pilot_samples), pixels));
  }
  text += fmt::format(", {:.2f} M samples/s and {:.2f} M rays/s while tracing, peak memory {:.0f} MiB\n",
                      per(static_cast<double>(totals.samples) * 1e-6, trace_s),
                      per(static_cast<double>(totals.rays) * 1e-6, trace_s), totals.peak_memory_mib);
  return text;
}

std::string summary_json(const FinishedRun& run) {
  const ResolvedJob& resolved = run.resolved;
  const SequenceResult& result = run.result;
  const Totals totals = add_up(result);
  nlohmann::ordered_json json;
  json["frames"] = format_frame_list(resolved.frames);
  json["rendered"] = result.rows.size();
  json["skipped"] = result.skipped.size();
  json["interrupted"] = result.interrupted;
  json["left"] = result.left.empty() ? "" : format_frame_list(result.left);
  json["settings_digest"] = resolved.pipeline.settings_digest;
  json["wall_s"] = run.wall_s;
  json["load_s"] = resolved.load_s;
  for (std::size_t i = 0; i < kStages.size(); ++i) {
    json["mean_ms"][kStages[i].name] = per(totals.ms[i], static_cast<double>(result.rows.size()));
  }
  json["samples"] = totals.samples;
  json["rays"] = totals.rays;
  json["pixels"] = totals.pixels;
  json["peak_memory_mib"] = totals.peak_memory_mib;
  json["warnings"] = nlohmann::ordered_json::array();
  for (const Warnings& warnings : {resolved.warnings, run.warnings}) {
    for (const std::string& warning : warnings) {
      json["warnings"].push_back(with_flags(warning));
    }
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
