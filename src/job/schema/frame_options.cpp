// SPDX-License-Identifier: Apache-2.0
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_frame_options(JobSchema& schema) {
  schema.group("Frames");
  schema.value("--size", &JobSettings::size, "WxH", Touch::frames, "Size of the pictures in pixels")
      .with(Trait::always_stated)
      .with(Trait::everyday);
  schema.value("--fps", &JobSettings::fps, "RATE", Touch::frames, "Frames a second: 24, 23.976 or 24000/1001")
      .with(Trait::always_stated);
  schema
      .value(
          "--frames,--only-frame", &JobSettings::frames, "LIST", Touch::frames,
          "Which frames, counted from 1: 1-100, 1-100x2, 3,7,9-12; fixations: one in the middle of each fixation, by "
          "the log's own events, else as 'gazetrace gaze events' detects them; default: as long as the animated "
          "camera, else the gaze log, else the scene's animation, else frame 1")
      .decides_nothing()
      .with(Trait::everyday);
  schema.value("--start", &JobSettings::start, "DURATION", Touch::frames, "Video time at which frame 1 begins");
  schema.value("--frame-rect", &JobSettings::frame_rect, "X,Y,W,H", Touch::frames,
               "Where the frame lies on the screen, in screen pixels; default: it fills the screen");
}

}  // namespace gazetrace
