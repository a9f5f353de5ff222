// SPDX-License-Identifier: Apache-2.0
// Changing a gaze log on purpose: mending, filtering, and degrading it for studies. Nothing happens unless asked for.
//
// Steps act on the one gaze of a log, in the order given; the eyes it was made of are dropped. They change what steers
// a rendering (`gaze_render`); measurements stay with the log as it was read.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

enum class GazeStepUnit : std::uint8_t { duration, degrees, hertz, count, share, number };

struct GazeStepParameter {
  std::string name;
  GazeStepUnit unit = GazeStepUnit::number;
  double value = 0;          // the default; of a duration in ns, which stays below 2^53
  double low = 0, high = 0;  // allowed, both included
};

struct GazeStepInfo {
  std::string name, description;
  std::vector<GazeStepParameter> parameters;
  bool is_oracle = false;  // looks at what comes later in a way that no tracker could
};
std::vector<GazeStepInfo> gaze_steps();

// A step with a value for each of its parameters.
struct GazeStep {
  std::string name;
  std::vector<GazeStepParameter> parameters;
  [[nodiscard]] double value(std::string_view parameter) const;
  [[nodiscard]] std::int64_t duration_ns(std::string_view parameter) const;
};

// "fill-gaps", "median:samples=5", "one-euro:min-cutoff=1.5hz,beta=0.3". Units may be written or left out, but those of
// durations. Error(usage) for unknown names and values out of range.
GazeStep parse_gaze_step(std::string_view text);
// With every parameter: parse_gaze_step(to_string(step)) is the step.
std::string to_string(const GazeStep& step);

struct ProcessedGaze {
  GazeLog log;
  // One line a step: "fill-gaps:max=75ms,angle=1deg: 12 gaps of 15 filled, 34 samples; ...".
  std::vector<std::string> reports;
  bool has_oracle = false;
};
// Linear time. Error(input) where a step needs angles and the log has none; Error(usage) where a filter does not fit
// the log's rate.
ProcessedGaze process_gaze(const GazeLog& log, const std::vector<GazeStep>& steps);

}  // namespace gazetrace
