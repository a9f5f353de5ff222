// SPDX-License-Identifier: Apache-2.0
// Changing a gaze log on purpose: mending it, filtering it, and degrading it for studies. Nothing happens unless it is
// asked for.
//
// Steps act on the combined gaze of a log, in the order given; the separate eyes are dropped. Steps change the gaze
// that steers a rendering (`gaze_render`); measurements still use the log as it was read.
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
  double value = 0;          // the default; durations are in ns, which stay below 2^53
  double low = 0, high = 0;  // the allowed range, both ends included
};

struct GazeStepInfo {
  std::string name, description;
  std::vector<GazeStepParameter> parameters;
  bool is_oracle = false;  // the step looks at later samples in a way that no tracker could
};
std::vector<GazeStepInfo> gaze_steps();

// A step with a value for each of its parameters.
struct GazeStep {
  std::string name;
  std::vector<GazeStepParameter> parameters;
  [[nodiscard]] double value(std::string_view parameter) const;
  [[nodiscard]] std::int64_t duration_ns(std::string_view parameter) const;
};

// Texts such as "fill-gaps", "median:samples=5", "one-euro:min-cutoff=1.5hz,beta=0.3". Durations need their unit; other
// units may be left out. Throws Error(usage) for unknown names and for values out of range.
GazeStep parse_gaze_step(std::string_view text);
// The text of a step with all of its parameters: parse_gaze_step(to_string(step)) gives the same step.
std::string to_string(const GazeStep& step);

struct ProcessedGaze {
  GazeLog log;
  // One line for each step: "fill-gaps:max=75ms,angle=1deg: 12 gaps of 15 filled, 34 samples; ...".
  std::vector<std::string> reports;
  bool has_oracle = false;
};
// Takes linear time. Throws Error(input) where a step needs angles and the log has none, and Error(usage) where a
// filter does not fit the log's rate.
ProcessedGaze process_gaze(const GazeLog& log, const std::vector<GazeStep>& steps);

}  // namespace gazetrace
