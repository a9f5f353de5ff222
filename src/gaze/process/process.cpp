// SPDX-License-Identifier: Apache-2.0
// The list of steps, their form as text, applying them one after another, and helpers of several steps.
#include "gaze/process/gaze_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/named.hpp"
#include "core/text.hpp"

namespace gazetrace {

#define GAZE_STEP(name, ...) std::string apply_##name(GazeLog&, const GazeStep&);
#include "gaze/process/steps/steps.def"
#undef GAZE_STEP

namespace {

const std::vector<GazeStepEntry>& entries() {
  static const std::vector<GazeStepEntry> kEntries{
#define GAZE_STEP(name, text, description, oracle, ...) {{text, description, {__VA_ARGS__}, oracle}, apply_##name},
#include "gaze/process/steps/steps.def"
#undef GAZE_STEP
  };
  return kEntries;
}

const GazeStepEntry& entry_by_name(std::string_view name) {
  return find_named(entries(), name, "gaze step", "");
}

std::string_view unit_text(GazeStepUnit unit) {
  return unit == GazeStepUnit::degrees ? "deg" : unit == GazeStepUnit::hertz ? "hz" : "";
}

[[noreturn]] void bad_value(std::string_view step, const GazeStepParameter& parameter, std::string_view text) {
  const std::string_view wanted = parameter.unit == GazeStepUnit::duration  ? "a duration with its unit, such as 50ms"
                                  : parameter.unit == GazeStepUnit::count   ? "a whole number"
                                  : parameter.unit == GazeStepUnit::degrees ? "a number of degrees"
                                  : parameter.unit == GazeStepUnit::share   ? "a share from 0 to 1"
                                                                            : "a number";
  const double scale = parameter.unit == GazeStepUnit::duration ? 1e-6 : 1;
  throw Error(ErrorKind::usage, fmt::format("gaze step {}", step),
              fmt::format("'{}' is not {} for {}", text, wanted, parameter.name),
              fmt::format("give {} to {}{}", parameter.low * scale, parameter.high * scale,
                          parameter.unit == GazeStepUnit::duration ? " ms" : ""));
}

double parse_parameter(std::string_view step, const GazeStepParameter& parameter, std::string_view text) {
  double value = 0;
  if (parameter.unit == GazeStepUnit::duration) {
    const std::size_t digits = text.find_first_not_of("0123456789.+-");
    std::int64_t ns = 0;
    const auto exponent = digits == std::string_view::npos ? std::nullopt : time_exponent(text.substr(digits));
    if (!exponent || scaled_integer(text.substr(0, digits), *exponent, ns) != NumberStatus::ok) {
      bad_value(step, parameter, text);
    }
    value = static_cast<double>(ns);
  } else {
    std::string_view digits = text;
    const std::string_view unit = unit_text(parameter.unit);
    if (!unit.empty() && to_lower(digits).ends_with(unit)) {
      digits.remove_suffix(unit.size());
    }
    const auto number = number_from(digits);
    if (!number || (parameter.unit == GazeStepUnit::count && *number != std::floor(*number))) {
      bad_value(step, parameter, text);
    }
    value = *number;
  }
  if (!(value >= parameter.low && value <= parameter.high)) {
    bad_value(step, parameter, text);
  }
  return value;
}

const GazeStepParameter& parameter_of(const GazeStep& step, std::string_view name) {
  return *std::find_if(step.parameters.begin(), step.parameters.end(),
                       [&](const GazeStepParameter& p) { return p.name == name; });
}

}  // namespace

std::vector<GazeStepInfo> gaze_steps() {
  return {entries().begin(), entries().end()};
}

double GazeStep::value(std::string_view parameter) const {
  return parameter_of(*this, parameter).value;
}

std::int64_t GazeStep::duration_ns(std::string_view parameter) const {
  return std::llround(parameter_of(*this, parameter).value);
}

GazeStep parse_gaze_step(std::string_view text) {
  const std::size_t colon = text.find(':');
  const GazeStepInfo& info = entry_by_name(trim(text.substr(0, colon)));
  GazeStep step{info.name, info.parameters};
  std::string_view rest = colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
  while (!rest.empty()) {
    const std::size_t comma = rest.find(',');
    const std::string_view pair = rest.substr(0, comma);
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
    const std::size_t equals = pair.find('=');
    const std::string_view name = trim(pair.substr(0, equals));
    std::vector<std::string> known;
    GazeStepParameter* found = nullptr;
    for (GazeStepParameter& parameter : step.parameters) {
      known.push_back(parameter.name);
      found = parameter.name == name ? &parameter : found;
    }
    if (found == nullptr || equals == std::string_view::npos) {
      throw Error(ErrorKind::usage, fmt::format("gaze step {}", step.name),
                  known.empty()      ? "it takes no parameters"
                  : found == nullptr ? unknown_name_message("parameter", name, known)
                                     : fmt::format("'{}' has no value; write {}=...", pair, name));
    }
    found->value = parse_parameter(step.name, *found, trim(pair.substr(equals + 1)));
  }
  return step;
}

std::string to_string(const GazeStep& step) {
  std::string text = step.name;
  char separator = ':';
  for (const GazeStepParameter& parameter : step.parameters) {
    if (parameter.unit == GazeStepUnit::duration) {
      const std::int64_t ns = std::llround(parameter.value);
      text += ns % 1'000'000 == 0 ? fmt::format("{}{}={}ms", separator, parameter.name, ns / 1'000'000)
                                  : fmt::format("{}{}={}ns", separator, parameter.name, ns);
    } else {
      text += fmt::format("{}{}={}{}", separator, parameter.name, parameter.value, unit_text(parameter.unit));
    }
    separator = ',';
  }
  return text;
}

ProcessedGaze process_gaze(const GazeLog& log, const std::vector<GazeStep>& steps) {
  ProcessedGaze processed{log, {}, false};
  if (steps.empty()) {
    return processed;
  }
  if (log.kind == GazeKind::scene_camera) {
    throw Error(ErrorKind::input, log.source, "gaze on a scene camera's picture has no angles to process it in",
                "use `frame` head, or a log mapped to a surface");
  }
  processed.log.eyes.clear();
  for (const GazeStep& step : steps) {
    const GazeStepEntry& entry = entry_by_name(step.name);
    const std::string said = entry.apply(processed.log, step);
    processed.reports.push_back(fmt::format("{}{}: {}", to_string(step), entry.is_oracle ? " (oracle)" : "", said));
    processed.has_oracle = processed.has_oracle || entry.is_oracle;
  }
  return processed;
}

std::vector<FilterRun> filter_runs(const GazeLog& log) {
  const std::int64_t most_ns = 3 * median_step_ns(times_of(log));
  const std::vector<GazeSample>& samples = log.samples;
  const auto is_good = [&](const GazeSample& s) { return is_usable(s.validity) && is_finite(place_of(s, log.kind)); };
  std::vector<FilterRun> runs;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!is_good(samples[i])) {
      continue;
    }
    const std::size_t first = i;
    while (i + 1 < samples.size() && is_good(samples[i + 1]) && samples[i + 1].t_ns - samples[i].t_ns <= most_ns) {
      ++i;
    }
    runs.push_back({first, i + 1});
  }
  return runs;
}

void set_place(GazeSample& sample, GazeKind kind, const Vec3d& place) {
  if (kind == GazeKind::direction) {
    sample.direction = normalize(place);
    return;
  }
  sample.u = place.x;
  sample.v = place.y;
  if (sample.validity == GazeValidity::ok || sample.validity == GazeValidity::off_screen) {
    const bool inside = place.x >= 0 && place.x <= 1 && place.y >= 0 && place.y <= 1;
    sample.validity = inside ? GazeValidity::ok : GazeValidity::off_screen;
  }
}

void set_direction(GazeSample& sample, GazeKind kind, const ScreenAngles& screen, const Vec3d& direction) {
  if (kind == GazeKind::direction) {
    sample.direction = direction;
    return;
  }
  const Vec2d at = screen.place(direction);
  if (is_finite(Vec3d{at.x, at.y, 0})) {
    set_place(sample, kind, {at.x, at.y, 0});
  } else {
    sample.validity = GazeValidity::lost;  // the gaze is turned away from the screen altogether
  }
}

}  // namespace gazetrace
