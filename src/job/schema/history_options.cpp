// SPDX-License-Identifier: Apache-2.0
#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

constexpr auto accumulate(auto member) {
  return at(&JobSettings::accumulate, member);
}

constexpr const char* kNeedsHistory = "`exposure-smoothing`";

void add_window_options(JobSchema& schema) {
  schema
      .value("--accumulate-past", &JobSettings::accumulate_past, "DURATION", Touch::history,
             "window: reads the frames of so much time before each frame; those outside the rendered range are traced "
             "for it")
      .at_least(0)
      .idle_when({without_window()});
  schema
      .value("--accumulate-future", &JobSettings::accumulate_future, "DURATION", Touch::history,
             "The same after each frame, which only offline rendering can; 0s: a causal window")
      .at_least(0)
      .idle_when({without_window()});
}

void add_checkpoint_options(JobSchema& schema) {
  schema
      .value("--checkpoint", &JobSettings::checkpoint, "FILE", Touch::history | Touch::output,
             "Saves the smoothed exposure after the last frame, to the bit; --resume makes "
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
      .value("--resume-from", &JobSettings::resume_from, "FILE", Touch::history,
             "Begins with the smoothed exposure of a checkpoint of the same settings, as if the frames before were in "
             "the same run")
      .decides_nothing()
      .with(Trait::one_run)
      .need(kNeedsHistory);
  schema
      .value("--preroll", &JobSettings::preroll, "N", Touch::history,
             "Renders up to N frames before the first to smooth the exposure from; they are not written")
      .decides_nothing()
      .with(Trait::one_run)
      .within(0, 1e6)
      .need(kNeedsHistory);
}

}  // namespace

void add_history_options(JobSchema& schema) {
  schema.group("Over time");
  schema
      .value(
          "--accumulate", accumulate(&AccumulateSettings::mode), choices<AccumulateMode>(), Touch::history,
          "window: each frame is reconstructed from its own samples and those of the frames around it, joined where "
          "they saw the same places of surfaces that move along with camera, bodies and shapes; what has changed its "
          "light meanwhile does not join")
      .with(Trait::always_stated);
  add_window_options(schema);
  add_checkpoint_options(schema);
}

}  // namespace gazetrace
