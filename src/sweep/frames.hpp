// SPDX-License-Identifier: Apache-2.0
// What a row's frames are scored as, and plans made from a test's plan: smaller, or steered by another gaze.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

// Events are gaze_class_of() gaze_true; a gaze that never moves fixates.
std::vector<ResultFrame> sweep_frames(const FramePlan& plan, const FoveationSettings& foveation, double leave_out_s);
// Which frames make the headline: fixations where there are any, else all that have gaze, else all; never those of the
// start.
std::vector<bool> scored_frames(const std::vector<ResultFrame>& frames);
// Share of each event in the frames; "start" is left out.
std::map<std::string, double> event_shares(const std::vector<ResultFrame>& frames);

struct RasterSize {
  int width_px = 0, height_px = 0;
};
// About `scale` of it, of the same aspect where a size of whole pixels near it has it.
RasterSize scaled_size(const RasterSize& size, double scale);
// The same frames on fewer pixels: the eye's view and the camera's picture keep their extent.
FramePlan resized(const FramePlan& plan, const RasterSize& size);

// Steered by a gaze that was not there, gaze_true as it was. shuffled: the gazes of the frames in another order, the
// same for the same plan; center: the middle of the frame; mirrored: through that middle. Empty where the wrong gaze is
// within 2 degrees of the right one on average, and for names that are none of these.
std::optional<FramePlan> with_wrong_gaze(const FramePlan& plan, const std::string& wrong);
const std::vector<std::string>& wrong_gazes();

}  // namespace gazetrace
