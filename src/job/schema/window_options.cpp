// SPDX-License-Identifier: Apache-2.0
#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {

void add_window_options(JobSchema& schema) {
  schema.group("Over time");
  schema
      .value(
          "--accumulate", at(&JobSettings::accumulate, &AccumulateSettings::mode), choices<AccumulateMode>(),
          Touch::window,
          "window: each frame is reconstructed from its own samples and those of the frames around it, joined where "
          "they saw the same places of surfaces, which follow camera, bodies and shapes. Surfaces whose light has "
          "changed do not join. auto: window for a sequence, off for a single still, for a stated quality and for raw "
          "samples (--filter none)")
      .with(Trait::always_stated);
  schema
      .value("--accumulate-past", &JobSettings::accumulate_past, "DURATION", Touch::window,
             "window: reads the frames of so much time before each frame; those outside the rendered range are traced "
             "for it. By default as much as keeps a window to 16 million pixels, but a frame on each side")
      .at_least(0)
      .idle_when({without_window()});
  schema
      .value("--accumulate-future", &JobSettings::accumulate_future, "DURATION", Touch::window,
             "The same after each frame, which only offline rendering can; 0s: a causal window")
      .at_least(0)
      .idle_when({without_window()});
}

}  // namespace gazetrace
