// SPDX-License-Identifier: Apache-2.0
// How the frames of a row are scored, and plans made from the plan of a test: smaller ones, or steered by another gaze.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

// The frames of a plan before anything is rendered. Events are the gaze_class_of() of gaze_true; a gaze that never
// moves counts as a fixation. Frames within `leave_out_s` of the first have the event "start".
std::vector<ResultFrame> sweep_frames(const FramePlan& plan, const FoveationSettings& foveation, double leave_out_s);
// Which frames are scored: those with a fixation where there are any, else all with gaze, else all; never those of the
// start.
std::vector<bool> scored_frames(const std::vector<ResultFrame>& frames);
// The share of each event among the frames; frames of the start are left out.
std::map<std::string, double> event_shares(const std::vector<ResultFrame>& frames);

struct RasterSize {
  int width_px = 0, height_px = 0;
};
// About `scale` times the size, with the same aspect where a size in whole pixels near it has that aspect.
RasterSize scaled_size(const RasterSize& size, double scale);
// The same frames on fewer pixels; the eye's view and the camera's picture keep their extent.
FramePlan resized(const FramePlan& plan, const RasterSize& size);

// The plan steered by a gaze that was not there, with gaze_true as it was. shuffled: the gazes of the frames in another
// order, which is the same for the same plan; center: the middle of the frame; mirrored: reflected through that middle.
// Empty where the wrong gaze is within 2 degrees of the right one on average, and for any other name.
std::optional<FramePlan> with_wrong_gaze(const FramePlan& plan, const std::string& wrong);
const std::vector<std::string>& wrong_gazes();

}  // namespace gazetrace
