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
             "two-sided: reads N frames before a frame and N after it, which are traced where they are not rendered")
      .within(0, 100)
      .idle_when({without_two_sided()});
  schema
      .value("--accumulate-order", accumulate(&A::order), choices<AccumulateOrder>(), Touch::history,
             "reproject: before or after the filter fills pixels between samples; guided: after")
      .idle_when({without_reproject()});
  schema
      .value("--accumulate-frames", accumulate(&A::frames), "N", Touch::history,
             "reproject, two-sided: memory in frames; a pixel gathers N times a frame's samples; 0 forgets nothing")
      .within(0, 1e9)
      .idle_when({without_reprojection()});
  schema
      .value("--accumulate-blend", accumulate(&A::blend), "SHARE", Touch::history,
             "reproject, two-sided: a fixed share of the current frame where there is history, 1e-6..1; 0: by samples")
      .within(0, 1)
      .idle_when({without_reprojection()});
  schema
      .value(
          "--accumulate-clip", accumulate(&A::clip_sigmas), "SIGMAS", Touch::history,
          "reproject, two-sided: other frames stay within so many standard deviations of the current neighborhood; 0: "
          "anywhere")
      .within(0, 1e6)
      .idle_when({without_reprojection()});
  schema
      .flag("--accumulate-reset-saccades", accumulate(&A::reset_at_saccades), Touch::history,
            "reproject, two-sided: a frame takes nothing from those before it where the eye has jumped since the last "
            "one")
      .idle_when({without_reprojection(), without_gaze_log()});
  schema
      .flag("--accumulate-reset-blinks", accumulate(&A::reset_at_blinks), Touch::history,
            "reproject, two-sided: a frame takes nothing from those before it where the eye was closed since the last "
            "one")
      .idle_when({without_reprojection(), without_gaze_log()});
}

void add_checkpoint_options(JobSchema& schema) {
  schema
      .value(
          "--checkpoint", &JobSettings::checkpoint, "FILE", Touch::history | Touch::output,
          "Keeps what is accumulated and the smoothed exposure, to the bit, after the last frame; --resume makes the "
          "file where it is missing")
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
      .value("--resume-from", &JobSettings::resume_from, "FILE", Touch::history,
             "Begins with a checkpoint, which must be of the same settings: as if in one run with the frames before")
      .decides_nothing()
      .with(Trait::one_run)
      .need(kNeedsHistory);
  schema
      .value("--preroll", &JobSettings::preroll, "N", Touch::history,
             "Renders up to N frames before the first for the history that they leave, and does not write them")
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
             "running: mean over frames while the camera stands still; reproject: what was seen before is looked up "
             "where camera, bodies and shapes have it now, and checked; two-sided: so are the frames after it, which "
             "nobody could do live")
      .with(Trait::always_stated);
  add_reproject_options(schema);
  add_checkpoint_options(schema);
}

}  // namespace gazetrace
