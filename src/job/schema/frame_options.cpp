// SPDX-License-Identifier: Apache-2.0
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_frame_options(JobSchema& schema) {
  schema.group("Frames");
  schema.value("--size", &JobSettings::size, "WxH", Touch::frames, "Size of the pictures in pixels")
      .with(Trait::always_stated);
  schema.value("--fps", &JobSettings::fps, "RATE", Touch::frames, "Frames a second: 24, 23.976 or 24000/1001")
      .with(Trait::always_stated);
  schema
      .value("--frames,--only-frame", &JobSettings::frames, "LIST", Touch::frames,
             "Which frames, counted from 1: 1-100, 1-100x2, 3,7,9-12; default: as long as the animated camera, else "
             "the gaze log, else the scene's animation, else frame 1")
      .decides_nothing();
  schema.value("--start", &JobSettings::start, "DURATION", Touch::frames, "Video time at which frame 1 begins");
  schema
      .value(
          "--chunk", &JobSettings::chunk, "K/N", Touch::frames,
          "Renders the K-th of N parts of the frames, which cost about the same by the samples of the plan; 1/1 makes "
          "all "
          "frames that are asked for a part of a longer sequence. Timing and "
          "run record carry its frames in their names, and 'gazetrace merge' joins all parts. The borders are the same "
          "for every task and are written down beside the outputs. Frames that depend on those before them need "
          "--resume-from or --preroll. A chunk without frames is done at once")
      .decides_nothing()
      .with(Trait::one_run);
  schema
      .value("--stage", &JobSettings::stage, choices<SequenceStage>(), Touch::frames,
             "For frames that depend on those before them: trace only traces frames, on any number of machines, and "
             "writes what was found beside the outputs (traced.0001.sparse); finish makes the pictures of such files, "
             "in order, to the bit those of a single run")
      .decides_nothing()
      .with(Trait::one_run);
  schema.value("--frame-rect", &JobSettings::frame_rect, "X,Y,W,H", Touch::frames,
               "Where the frame lies on the screen, in screen pixels; default: it fills the screen");
}

}  // namespace gazetrace
