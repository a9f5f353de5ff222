// SPDX-License-Identifier: Apache-2.0
#include "job/judged_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "job/judged_frames.hpp"
#include "job/outputs.hpp"
#include "job/scene.hpp"

namespace gazetrace {
namespace {

double frames_per_second(const FrameRate& fps) {
  return static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator);
}

// How many frames the sequence has, and whether view or gaze differs between them.
struct SequenceLength {
  std::int32_t frames = 1;
  bool differs = false;
};

SequenceLength sequence_length(const JobSettings& job, const ViewInputs& inputs) {
  const std::size_t frames = frames_of_sequence(job, inputs).size();
  if (frames > 1) {
    return {static_cast<std::int32_t>(frames), true};
  }
  // Only where the camera stands still for as long as one likes.
  const bool rests = job.frames && inputs.camera.is_static;
  return {rests ? static_cast<std::int32_t>(std::max(1.0, std::round(frames_per_second(job.fps)))) : 1, false};
}

// All that are traced for the judged ones. A still is judged by several examples of its one frame, of which only that
// frame need exist: a camera's path may end there.
std::vector<std::int32_t> frames_to_plan(const JudgedNumbers& judged, const AccumulateSettings& reach,
                                         const CameraPath& camera, const PlanSettings& plan) {
  std::set<std::int32_t> all{1};
  for (const std::vector<std::int32_t>& run : judged.runs) {
    for (const std::int32_t frame : run) {
      for (std::int32_t apart = -reach.past_frames; apart <= reach.future_frames; ++apart) {
        const bool is_of_sequence = apart == 0 && judged.sequence_frames > 1;
        if (is_of_sequence || has_frame(camera, plan, std::int64_t{frame} + apart)) {
          all.insert(frame + apart);
        }
      }
    }
  }
  return {all.begin(), all.end()};
}

}  // namespace

JudgedFrames plan_judged_frames(const JobSettings& job, const ViewInputs& inputs, PlanSettings plan,
                                Decisions& decisions) {
  const bool view_moves = !inputs.camera.is_static || (inputs.scene != nullptr && moves(*inputs.scene));
  const SequenceLength length = sequence_length(job, inputs);
  if (length.frames > 1 && !sees_changes(job.fps)) {
    throw Error(ErrorKind::usage, "`target-jod`",
                fmt::format("{:g} frames a second are too few for its metric, which measures changes within a "
                            "quarter of a second",
                            frames_per_second(job.fps)),
                "give a higher `fps`, or a budget");
  }
  // What joins a frame grows until its window is full.
  const LaterFrames later = length.differs                                  ? LaterFrames::all_differ
                            : job.accumulate.mode == AccumulateMode::window ? LaterFrames::as_the_middle
                                                                            : LaterFrames::as_early_ones;
  if (length.frames > 1 && !view_moves && job.accumulate.mode == AccumulateMode::off) {
    decisions.emplace_back("accumulate",
                           "off; the view is at rest, and with `accumulate` window frames share their samples and "
                           "take many times fewer for this quality");
  }
  const JudgedNumbers numbers = judged_numbers(length.frames, later, job.fps);
  plan.frames = frames_to_plan(numbers, accumulate_of(job), inputs.camera, plan);
  plan.most_frames_without_gaze = 0;  // they are chosen by their number, and may lie behind the log's end
  FramePlan planned = plan_frames(inputs.camera, inputs.log, plan, inputs.steering);

  JudgedFrames judged;
  judged.sequence_frames = numbers.sequence_frames;
  judged.view_moves = view_moves && numbers.sequence_frames > 1;
  judged.gaze_moves = length.differs && inputs.log != nullptr && !job.gaze_at;
  judged.runs.resize(numbers.runs.size());
  for (FrameRequest& request : planned.frames) {
    std::vector<FrameRequest>* to = &judged.around;
    for (std::size_t k = 0; k < numbers.runs.size(); ++k) {
      const std::vector<std::int32_t>& run = numbers.runs[k];
      to = std::find(run.begin(), run.end(), request.frame) != run.end() ? &judged.runs[k] : to;
    }
    to->push_back(std::move(request));
  }
  for (std::size_t k = 0; k < judged.runs.size(); ++k) {
    if (judged.runs[k].empty()) {  // a further example of a still
      judged.runs[k].push_back(judged.runs.front().front());
      judged.runs[k].back().frame = numbers.runs[k].front();
    }
  }
  return judged;
}

}  // namespace gazetrace
