// SPDX-License-Identifier: Apache-2.0
#include "job/job_plan.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include "job/choose_frames.hpp"
#include "job/chunks.hpp"
#include "job/gaze_inputs.hpp"
#include "job/outputs.hpp"
#include "job/plan_settings.hpp"
#include "pipeline/frame_part.hpp"

namespace gazetrace {
namespace {

// Whether there are rates for a frame that nobody asked for.
bool has_density_picture(const FoveationSettings& foveation, std::int64_t frame) {
  const std::string files = picture_files_of(foveation.sampling);
  return !has_frame_number(files) || std::filesystem::exists(frame_file_name(files, static_cast<std::int32_t>(frame)));
}

// The frames that those of the plan read beside each other. They exist from frame 1 on and as far as the camera's path
// goes, whether or not they are rendered, so that a frame is the same in every run.
void add_frames_around(const JobSettings& job, const CameraPath& camera, ResolvedJob& resolved) {
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  PlanSettings settings = resolved.plan_settings;
  const std::set<std::int32_t> asked(settings.frames.begin(), settings.frames.end());
  std::set<std::int32_t> all = asked;
  const AccumulateSettings reach = accumulate_of(job);
  for (const std::int32_t frame : asked) {
    for (std::int32_t apart = -reach.past_frames; apart <= reach.future_frames; ++apart) {
      const std::int64_t near = std::int64_t{frame} + apart;
      if (has_frame(camera, settings, near) && has_density_picture(job.foveation, near)) {
        all.insert(frame + apart);
      }
    }
  }
  settings.frames.assign(all.begin(), all.end());
  // What the eye did since the frame before is asked of neighbours, so that it is that of this plan.
  FramePlan whole = plan_frames(camera, log, settings, resolved.steering ? &*resolved.steering : nullptr);
  resolved.plan.frames.clear();
  for (FrameRequest& request : whole.frames) {
    (asked.contains(request.frame) ? resolved.plan.frames : resolved.plan.around).push_back(std::move(request));
  }
  if (const std::size_t more = resolved.plan.around.size(); more > 0) {
    resolved.decisions.emplace_back(
        "accumulate", fmt::format("{} more frame{} traced for the windows of these {}; parts of a sequence trace those "
                                  "around their own, up to {} a part",
                                  more, more == 1 ? " is" : "s are", resolved.plan.frames.size(),
                                  reach.past_frames + reach.future_frames));
  }
}

// Requests become windows of their frames.
void keep_to_crop(const JobSettings& job, FramePlan& plan) {
  if (!job.crop) {
    return;
  }
  const PixelRect rect{job.crop->x_px, job.crop->y_px, job.crop->width_px, job.crop->height_px};
  if (rect.right_px() > job.size.width || rect.bottom_px() > job.size.height) {
    throw Error(ErrorKind::usage, "`crop`",
                fmt::format("{} does not lie in a frame of {} x {} pixels", format_value(*job.crop), job.size.width,
                            job.size.height),
                "give X,Y of its top left corner, and its width and height");
  }
  if (follows_picture(job.foveation.sampling)) {
    throw Error(ErrorKind::usage, "`crop`", "densities that are pictures are of whole frames",
                "leave it out, or choose another `sampling`");
  }
  for (std::vector<FrameRequest>* frames : {&plan.frames, &plan.around}) {
    for (FrameRequest& request : *frames) {
      request = window_of(request, rect);
    }
  }
}

}  // namespace

void keep_to_chunk(const JobSettings& job, const CameraPath& camera, std::int64_t taken_off_ns, ResolvedJob& resolved) {
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  Decisions unused;
  const FramePlan whole =
      plan_frames(camera, log, plan_settings(job, resolved.frames, log, taken_off_ns, unused), nullptr);
  ChosenChunk chosen = choose_chunk(job, whole);
  resolved.frames = std::move(chosen.frames);
  resolved.chunk_borders = std::move(chosen.borders);
  resolved.decisions.emplace_back("chunk", chosen.decision);
}

void make_plan(const JobSettings& job, const CameraPath& camera, std::int64_t taken_off_ns, ResolvedJob& resolved) {
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  PlanSettings settings = plan_settings(job, resolved.frames, log, taken_off_ns, resolved.decisions);
  if (log != nullptr && !job.gaze_at && !job.gaze_process.empty()) {
    resolved.steering = process_gaze(*log, gaze_steps_of(job.gaze_process));
    resolved.decisions.emplace_back("gaze processing", fmt::format("{}", fmt::join(resolved.steering->reports, "; ")));
  }
  resolved.plan = plan_frames(camera, log, settings, resolved.steering ? &*resolved.steering : nullptr);
  resolved.plan_settings = std::move(settings);
  if (job.accumulate.mode == AccumulateMode::window) {
    add_frames_around(job, camera, resolved);
  }
  keep_to_crop(job, resolved.plan);
  if (resolved.plan.ages && !job.gaze_at) {
    resolved.decisions.emplace_back("effective gaze age", gaze_ages_text(*resolved.plan.ages));
  }
}

}  // namespace gazetrace
