// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/compare.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

std::string_view to_string(GazeClass gaze_class) {
  switch (gaze_class) {
    case GazeClass::fixation:
      return "fixation";
    case GazeClass::in_flight:
      return "in-flight";
    case GazeClass::blink:
      return "blink";
    case GazeClass::no_gaze:
      return "no-gaze";
    case GazeClass::unclassified:
      break;
  }
  return "unclassified";
}

GazeClass gaze_class_of(const GazeAtTime& gaze) {
  if (gaze.movement == EyeMovement::blink) {
    return GazeClass::blink;
  }
  if (gaze.no_gaze || gaze.state == GazeState::none || gaze.movement == EyeMovement::lost) {
    return GazeClass::no_gaze;
  }
  if (gaze.movement == EyeMovement::saccade || (gaze.since_saccade_ns && *gaze.since_saccade_ns <= kAfterSaccadeNs)) {
    return GazeClass::in_flight;
  }
  return gaze.movement == EyeMovement::fixation ? GazeClass::fixation : GazeClass::unclassified;
}

RetinalRegions retinal_regions(const std::array<double, 2>& eccentricities_deg) {
  if (!(eccentricities_deg[0] > 0 && eccentricities_deg[1] > eccentricities_deg[0])) {
    throw Error(ErrorKind::usage, "`region-eccentricities`",
                fmt::format("{},{} do not ascend", eccentricities_deg[0], eccentricities_deg[1]),
                "give two angles above 0, the smaller first");
  }
  return {eccentricities_deg};
}

const SequenceScores& headline(const std::vector<SequenceScores>& summary) {
  const auto fixations = std::find_if(summary.begin(), summary.end(), [](const SequenceScores& part) {
    return part.gaze_class == to_string(GazeClass::fixation);
  });
  return fixations == summary.end() ? summary.front() : *fixations;
}

}  // namespace gazetrace
