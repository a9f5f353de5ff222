// SPDX-License-Identifier: Apache-2.0
// I-VDT, velocity and dispersion thresholds: what is faster than a threshold is a saccade; of the rest, a window slides
// until the gaze stays within D in it and then grows as long as it does, and is a fixation; what the window passes over
// is a pursuit. Komogortsev & Karpov, "Automated classification and scoring of smooth pursuit eye movements in the
// presence of fixations and saccades", Behavior Research Methods 45, 2013.
//
// The paper's: the order of these steps, the three thresholds (velocity, dispersion, length of the window), and the
// dispersion as extent of x plus extent of y. 70 deg/s, 2 deg and 110 ms are quoted as that paper's from those who cite
// it; its text was not at hand when they were written down here.
//
// Ours: velocities are taken over EventSettings::velocity_window_ns (20 ms) instead of from sample to sample, where
// noise of 0.05 deg at 500 Hz alone comes near 70 deg/s (tests/benchmarks/book/gaze-agreement.md holds both against
// each other and against the truth). The window of the paper runs over the trace without its saccades; here it does not
// reach over a saccade or a loss. Samples too close to the end of such a stretch to fill a window are what the sample
// before them is; in a stretch shorter than the window, the dispersion of all of it decides. Fixations and pursuits
// shorter than EventSettings::min_fixation_ns are dropped.
#include <cstddef>

#include "gaze/angles.hpp"
#include "gaze/events/dispersion_window.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {
namespace {

void split_stretch(const GazeDirections& gaze, std::size_t first, std::size_t end, EyeEvents& events) {
  const EventSettings& settings = events.settings;
  label_samples(events.labels, first, end, EyeMovement::pursuit);
  DispersionWindow window(gaze.direction);
  const auto fixate = [&](std::size_t from, std::size_t to) {
    label_samples(events.labels, from, to, EyeMovement::fixation);
  };
  const std::size_t rest =
      find_still(gaze, first, end, settings.dispersion_window_ns, settings.dispersion_deg, window, fixate);
  if (rest < end) {
    const bool follows_fixation = rest > first && events.labels[rest - 1] == EyeMovement::fixation;
    const bool is_alone = rest == first && window.dispersion_deg() <= settings.dispersion_deg;
    if (follows_fixation || is_alone) {
      fixate(rest, end);
    }
  }
}

}  // namespace

void classify_ivdt(const GazeDirections& gaze, EyeEvents& events) {
  const std::vector<double> speed = angular_speed_deg_s(gaze, events.settings.velocity_window_ns);
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (speed[i] >= events.settings.velocity_deg_s) {
      events.labels[i] = EyeMovement::saccade;
    }
  }
  for (const LabelRun& run : label_runs(events.labels, gaze.t_ns)) {
    if (run.movement == EyeMovement::unclassified) {
      split_stretch(gaze, run.first, run.last + 1, events);
    }
  }
  drop_short(EyeMovement::fixation, gaze, events);
  // A pursuit as short as a fixation that is not kept is the flank of a saccade.
  drop_short(EyeMovement::pursuit, gaze, events);
}

}  // namespace gazetrace
