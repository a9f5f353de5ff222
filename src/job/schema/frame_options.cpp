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
          "Frames: 1-100, 1-100x2, 3,7,9-12. fixations: one in the middle of each fixation, by the log's own "
          "events, else by 'gazetrace gaze events'. Default: as long as the animated camera, else the gaze log, else "
          "the scene's animation, else the first frame")
      .decides_nothing()
      .with(Trait::everyday);
  schema
      .value(
          "--first-frame", &JobSettings::first_frame, "N", Touch::frames,
          "Number of the frame at the beginning of the camera's path: with 1001 frames are counted from 1001, and show "
          "the same moments")
      .within(1, 1e9);
  schema.value("--start", &JobSettings::start, "DURATION", Touch::frames, "Video time at which the first frame begins");
  schema.value(
      "--crop", &JobSettings::crop, "X,Y,W,H", Touch::frames,
      "Renders this rectangle of the frames alone, in pixels from the top left: the data window of an .exr, whose "
      "display window stays the whole frame, and all of a display picture");
  schema.value("--frame-rect", &JobSettings::frame_rect, "X,Y,W,H", Touch::frames,
               "Where the frame lies on the screen, in screen pixels; default: it fills the screen");
}

}  // namespace gazetrace
