// SPDX-License-Identifier: Apache-2.0
// The record of a run, in which it describes itself.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "gazetrace/build_info.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/version.hpp"
#include "pipeline/file_journal.hpp"

namespace gazetrace {

namespace fs = std::filesystem;

namespace {

// The rate that an earlier run of the same settings chose: where all its frames are there, it is not chosen again.
void keep_chosen_rate(const std::string& record_path, RunRecord& record) {
  std::error_code ignored;
  if (!std::filesystem::exists(record_path, ignored)) {
    return;
  }
  try {
    const RunRecord earlier = read_run_record(record_path);
    const auto rate = earlier.facts.find("rate");
    if (earlier.settings_digest == record.settings_digest && rate != earlier.facts.end()) {
      record.facts.insert(*rate);
    }
  } catch (const Error&) {
    // A damaged record tells nothing, and is about to be replaced.
  }
}

}  // namespace

RunRecord start_run_record(const ResolvedJob& resolved, const PathTracer& tracer, const ColorPipeline& color,
                           const std::vector<std::string>& command_line) {
  const PipelineSettings& settings = resolved.pipeline;
  RunRecord record;
  record.version = kVersion;
  record.build = build_description();
  record.instruction_set = instruction_set();
  record.ray_library = tracer.ray_library();
  record.denoiser = resolved.job.settings.filter == "oidn" ? denoiser_description() : "";
  record.command_line = command_line;
  record.config_toml = job_as_toml(resolved.job);
  record.settings_digest = settings.settings_digest;
  record.input_digests = resolved.input_digests;
  record.frames = format_frame_list(resolved.frames);
  const std::vector<std::string> outputs = output_files(settings, resolved.frames);
  if (settings.output.resume && !outputs.empty()) {
    record.files = read_earlier_files(outputs.front());  // the file of the record is about to be replaced
    keep_chosen_rate(outputs.front(), record);
  }
  record.is_part = settings.is_part;
  record.chunk_file = fs::path(resolved.chunk_borders.path).filename().string();
  record.warnings = resolved.warnings;
  for (const auto& [name, text] : resolved.decisions) {
    std::string& fact = record.facts[name];  // there may be several of one name, as an option may be replaced twice
    fact += (fact.empty() ? "" : "; ") + text;
  }
  record.facts["working_space"] = "linear Rec.709, D65";
  record.facts["view"] = color.description();
  record.facts["load_s"] = fmt::format("{:.3f}", resolved.load_s);
  record.facts["bvh_build_s"] = fmt::format("{:.3f}", tracer.memory().build_s);
  record.facts["bvh_mib"] = fmt::format("{:.1f}", static_cast<double>(tracer.memory().bvh_bytes) / 1048576.0);
  if (settings.accumulate.future_frames > 0) {
    record.facts["causal"] = "false";  // frames use others that come after them
  }
  record.facts["state"] = "running";
  return record;
}

void finish_run_record(RunRecord& record, const SequenceResult& result, const FramePlan& plan, double wall_s) {
  record.facts["state"] = result.interrupted ? "interrupted" : "done";
  record.facts["wall_s"] = fmt::format("{:.3f}", wall_s);
  record.facts["peak_memory_mib"] = fmt::format("{:.1f}", peak_memory_mib());
  const Warnings late = result_warnings(result, plan);
  record.warnings.insert(record.warnings.end(), late.begin(), late.end());
  for (const auto& [name, text] : result.facts) {
    record.facts.insert_or_assign(name, text);
  }
  record.bad_samples = result.bad_samples;
  record.files = result.files;
}

// The share of all camera rays from which on it is no chance of an edge.
constexpr double kNoticedBacks = 1e-3;

Warnings result_warnings(const SequenceResult& result, const FramePlan& plan) {
  Warnings warnings = result.warnings;
  const auto count = [&](GazeState state) {
    return std::count_if(plan.frames.begin(), plan.frames.end(),
                         [&](const FrameRequest& request) { return request.gaze_render.state == state; });
  };
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
    warnings.push_back(fmt::format("{} values were clamped to the range of half floats; `exr-pixels` float keeps them",
                                   result.clamped_half_values));
  }
  if (result.dark_pictures > 0) {
    warnings.push_back(
        fmt::format("{} of {} pictures {} dark, half of each below 2 % of white: `exposure` (auto, auto+2 or a "
                    "number of stops) and `env` (sky, or a picture) bring light",
                    result.dark_pictures, result.rows.size(), result.dark_pictures == 1 ? "is" : "are"));
  }
  const double backs =
      static_cast<double>(result.seen_backs) / static_cast<double>(std::max<std::uint64_t>(result.camera_rays, 1));
  if (backs >= kNoticedBacks) {
    warnings.push_back(fmt::format(
        "in {:.2g} % of the pictures' area, by their samples, the camera sees the back of faces that are not "
        "double-sided, which glTF does not draw: `cull-back-faces` looks through them",
        100 * backs));
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
          "; the first: {} in frame {}, pixel {},{}, sample {}; replay it with `frames` {} `only-pixel` {},{}",
          first.what, first.frame, first.x_px, first.y_px, first.sample, first.frame, first.x_px, first.y_px);
    }
    warnings.push_back(text);
  }
  return warnings;
}

}  // namespace gazetrace
