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
constexpr std::array<Stage, 9> kStages{{{"plan", &TimingRow::plan_ms},
                                        {"trace", &TimingRow::trace_ms},
                                        {"guides", &TimingRow::guides_ms},
                                        {"reconstruct", &TimingRow::reconstruct_ms},
                                        {"temporal", &TimingRow::temporal_ms},
                                        {"exposure", &TimingRow::exposure_ms},
                                        {"color", &TimingRow::color_ms},
                                        {"write", &TimingRow::write_ms},
                                        {"total", &TimingRow::total_ms}}};

struct Totals {
  std::array<double, kStages.size()> ms{};
  std::uint64_t samples = 0, rays = 0, pixels = 0;
  double peak_memory_mib = 0;
};

Totals add_up(const SequenceResult& result) {
  Totals totals;
  for (const TimingRow& row : result.rows) {
    for (std::size_t i = 0; i < kStages.size(); ++i) {
      totals.ms[i] += row.*kStages[i].ms;
    }
    totals.samples += row.samples;
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
  const double trace_s = totals.ms[1] * 1e-3;
  text += fmt::format(
      "\n{:.3f} samples a pixel, {:.2f} M samples/s and {:.2f} M rays/s while tracing, peak memory {:.0f} MiB\n",
      per(static_cast<double>(totals.samples), static_cast<double>(totals.pixels)),
      per(static_cast<double>(totals.samples) * 1e-6, trace_s), per(static_cast<double>(totals.rays) * 1e-6, trace_s),
      totals.peak_memory_mib);
  return text;
}

std::string summary_json(const SequenceResult& result, const Inputs& inputs, const PipelineSettings& settings,
                         double wall_s) {
  const Totals totals = add_up(result);
  nlohmann::ordered_json json;
  json["frames"] = format_frame_list(inputs.frames);
  json["rendered"] = result.rows.size();
  json["skipped"] = result.skipped.size();
  json["settings_digest"] = settings.settings_digest;
  json["wall_s"] = wall_s;
  json["load_s"] = inputs.load_s;
  for (std::size_t i = 0; i < kStages.size(); ++i) {
    json["mean_ms"][kStages[i].name] = per(totals.ms[i], static_cast<double>(result.rows.size()));
  }
  json["samples"] = totals.samples;
  json["rays"] = totals.rays;
  json["pixels"] = totals.pixels;
  json["peak_memory_mib"] = totals.peak_memory_mib;
  json["warnings"] = with_flags(inputs.warnings);
  for (const std::string& warning : with_flags(result_warnings(result, inputs.plan))) {
    json["warnings"].push_back(warning);
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Warnings result_warnings(const SequenceResult& result, const FramePlan& plan) {
  Warnings warnings = result.warnings;
  const auto count = [&](GazeState state) {
    return std::count_if(plan.frames.begin(), plan.frames.end(),
                         [&](const FrameRequest& request) { return request.gaze_render.state == state; });
  };
  const auto held = std::count_if(plan.frames.begin(), plan.frames.end(), [](const FrameRequest& request) {
    return request.gaze_render.no_gaze && request.gaze_render.state == GazeState::held;
  });
  if (held > 0) {
    warnings.push_back(fmt::format("{} frames without gaze hold the nearest one in the past, or the first", held));
  }
  const auto centered = count(GazeState::center);
  const bool has_gaze = std::any_of(plan.frames.begin(), plan.frames.end(), [](const FrameRequest& request) {
    return request.gaze_render.state != GazeState::none;
  });
  if (centered > 0) {
    warnings.push_back(fmt::format("{} frames without gaze look at the centre", centered));
  }
  if (const auto uniform = count(GazeState::none); uniform > 0 && has_gaze) {
    warnings.push_back(fmt::format("{} frames without gaze are rendered uniformly", uniform));
  }
  if (result.clamped_half_values > 0) {
    warnings.push_back(fmt::format("{} values were clamped to the range of half floats; --exr-pixels float keeps them",
                                   result.clamped_half_values));
  }
  if (result.clamped_view_pixels > 0) {
    warnings.push_back(fmt::format("{} pixels were clamped before the viewing transform", result.clamped_view_pixels));
  }
  std::uint64_t non_finite = 0;
  std::uint64_t rejected = 0;
  for (const TimingRow& row : result.rows) {
    non_finite += row.non_finite_samples;
    rejected += row.rejected_rays;
  }
  if (non_finite + rejected > 0) {
    std::string text = fmt::format("{} samples were not finite and {} rays were rejected", non_finite, rejected);
    if (!result.bad_samples.empty()) {
      const BadSample& first = result.bad_samples.front();
      text += fmt::format(
          "; the first: {} in frame {}, pixel {},{}, sample {}; replay it with --only-frame {} --only-pixel {},{}",
          first.what, first.frame, first.x_px, first.y_px, first.sample, first.frame, first.x_px, first.y_px);
    }
    warnings.push_back(text);
  }
  return warnings;
}

}  // namespace gazetrace
