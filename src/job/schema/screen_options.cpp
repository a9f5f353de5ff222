// SPDX-License-Identifier: Apache-2.0
#include "job/schema/parts.hpp"

namespace gazetrace {

OptionSchema<ScreenSettings> screen_schema() {
  OptionSchema<ScreenSettings> schema;
  schema.group("Screen (where the eye is)");
  schema
      .value(
          "--screen", &ScreenSettings::name, "NAME|FILE", Touch::screen,
          "A known screen and its distance ('gazetrace list screens'), or a .json file; default: that of the gaze log")
      .with(Trait::everyday);
  schema.value("--screen-px", &ScreenSettings::size_px, "W,H", Touch::screen, "Resolution of the screen");
  schema.value("--screen-cm", &ScreenSettings::size_cm, "W,H", Touch::screen,
               "Size of the screen's active area, centimetres");
  schema.value("--screen-distance-cm", &ScreenSettings::distance_cm, "CM", Touch::screen,
               "Distance from the eye to the screen, centimetres");
  schema.value("--screen-eye-cm", &ScreenSettings::eye_cm, "X,Y", Touch::screen,
               "Where the eye's perpendicular meets the screen, from its centre, right and up, centimetres");
  schema
      .value("--screen-ppd", &ScreenSettings::pixels_per_degree, "PIXELS", Touch::screen,
             "Pixels a degree in the middle of the screen, in place of its size and distance")
      .need("the screen's pixels, by `screen` or `screen-px`");
  return schema;
}

// Only rendered pictures are viewed on another screen than the one of the recording.
void add_screen_options(JobSchema& schema) {
  schema.include(screen_schema(), &JobSettings::screen);
  schema.value("--recording-screen", &JobSettings::recording_screen, "NAME|FILE", Touch::screen,
               "The screen of the recording, if it differs from --screen; default: that of the gaze log");
  schema.value("--gaze-transfer", &JobSettings::gaze_transfer, choices<GazeTransfer>(), Touch::screen,
               "How gaze is carried from the recording's screen to another: its place on the screen stays the same "
               "(fraction), or its angle does; needed where the angular sizes of the screens differ by more than 2 %");
}

}  // namespace gazetrace
