// SPDX-License-Identifier: Apache-2.0
#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

constexpr auto accumulate(auto member) {
  return at(&JobSettings::accumulate, member);
}

constexpr const char* kNeedsHistory = "`accumulate` or `exposure-smoothing`";

void add_reproject_options(JobSchema& schema) {
  using A = AccumulateSettings;
  schema
      .value("--accumulate-window", accumulate(&A::window), "N", Touch::history,
             "two-sided: reads N frames before each frame and N after it; those outside the rendered range are traced "
             "for it")
      .within(0, 100)
      .idle_when({without_two_sided()});
  schema
      .value("--accumulate-hold", accumulate(&A::hold), "N", Touch::history,
             "two-sided, where nothing moves: N frames after each other show one sum, which is filtered once; 0: a "
             "third of --accumulate-window. More than --accumulate-window + 1 counts as that")
      .within(0, 100)
      .idle_when({without_two_sided()});
  schema
      .value("--accumulate-order", accumulate(&A::order), choices<AccumulateOrder>(), Touch::history,
             "reproject: accumulates before or after the filter fills the pixels between samples; guided allows only "
             "after")
      .idle_when({without_reproject()});
  schema
      .value("--accumulate-frames", accumulate(&A::frames), "N", Touch::history,
             "reproject, two-sided: the memory's length in frames: a pixel gathers up to N times a frame's samples; 0: "
             "unlimited")
      .within(0, 1e9)
      .idle_when({without_reprojection()});
  schema
      .value("--accumulate-blend", accumulate(&A::blend), "SHARE", Touch::history,
             "reproject, two-sided: fixed weight of the current frame where there is history, 1e-6 to 1; 0: weights by "
             "numbers of samples")
      .within(0, 1)
      .idle_when({without_reprojection()});
  schema
      .value("--accumulate-clip", accumulate(&A::clip_sigmas), "SIGMAS", Touch::history,
             "reproject, two-sided: clips the history to within this many standard deviations of the current "
             "neighbourhood; 0: does not clip")
      .within(0, 1e6)
      .idle_when({without_reprojection()});
  schema
      .flag("--accumulate-reset-saccades", accumulate(&A::reset_at_saccades), Touch::history,
            "reproject, two-sided: rejects the history of a frame if a saccade happened since the frame before")
      .idle_when({without_reprojection(), without_gaze_log()});
  schema
      .flag("--accumulate-reset-blinks", accumulate(&A::reset_at_blinks), Touch::history,
            "reproject, two-sided: rejects the history of a frame if a blink happened since the frame before")
      .idle_when({without_reprojection(), without_gaze_log()});
}

void add_checkpoint_options(JobSchema& schema) {
  schema
      .value("--checkpoint", &JobSettings::checkpoint, "FILE", Touch::history | Touch::output,
             "Saves the accumulated history and the smoothed exposure after the last frame, to the bit; --resume makes "
             "the file where it is missing")
      .decides_nothing()
      .with(Trait::one_run)
      .need(kNeedsHistory);
  schema
      .value("--checkpoint-every", &JobSettings::checkpoint_every, "N", Touch::history | Touch::output,
             "Writes the checkpoint after every N frames as well; 0: only at the end")
      .decides_nothing()
      .with(Trait::one_run)
      .within(0, 1e9)
      .need("`checkpoint`");
  schema
      .value(
          "--resume-from", &JobSettings::resume_from, "FILE", Touch::history,
          "Begins with the history of a checkpoint of the same settings, as if the frames before were in the same run")
      .decides_nothing()
      .with(Trait::one_run)
      .need(kNeedsHistory);
  schema
      .value("--preroll", &JobSettings::preroll, "N", Touch::history,
             "Renders up to N frames before the first to build up history; they are not written")
      .decides_nothing()
      .with(Trait::one_run)
      .within(0, 1e6)
      .need(kNeedsHistory);
}

}  // namespace

void add_history_options(JobSchema& schema) {
  schema.group("Over time");
  schema
      .value("--accumulate", accumulate(&AccumulateSettings::mode), choices<AccumulateMode>(), Touch::history,
             "running: mean over frames while the camera is at rest; reproject: looks up earlier frames where the "
             "surfaces of this one were, following camera, bodies and shapes, and rejects what does not match; "
             "two-sided: takes later frames as well, which only offline rendering can")
      .with(Trait::always_stated);
  add_reproject_options(schema);
  add_checkpoint_options(schema);
}

}  // namespace gazetrace
