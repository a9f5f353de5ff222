// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <sstream>
#include <string_view>

#include "core/image_io.hpp"
#include "core/text.hpp"
#include "gazetrace/compare.hpp"
#include "output/exr.hpp"

namespace gazetrace {
namespace {

// The value of `key=value` among words.
std::string value_of(const std::string& text, std::string_view key) {
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (word.starts_with(key) && word.size() > key.size() && word[key.size()] == '=') {
      return word.substr(key.size() + 1);
    }
  }
  return {};
}

std::optional<std::int64_t> integer_of(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

template <class Named>
std::optional<Named> named(const std::string& name, std::initializer_list<Named> values) {
  for (const Named value : values) {
    if (to_string(value) == name) {
      return value;
    }
  }
  return std::nullopt;
}

void take_gaze(const std::string& text, FrameFacts& facts) {
  const auto state =
      named(value_of(text, "state"), {GazeState::measured, GazeState::held, GazeState::center, GazeState::none});
  const std::string direction = value_of(text, "direction");
  const std::optional<double> u = number_from(value_of(text, "u"));
  const std::optional<double> v = number_from(value_of(text, "v"));
  const std::string no_gaze = value_of(text, "no_gaze");
  const bool has_place = u && v;
  if (!state || (!has_place && direction.empty()) || no_gaze.empty()) {
    return;
  }
  GazeAtTime gaze;
  gaze.state = *state;
  if (has_place) {
    gaze.u = *u;
    gaze.v = *v;
  }
  gaze.no_gaze = no_gaze == "1";
  gaze.movement = named(value_of(text, "event"),
                        {EyeMovement::fixation, EyeMovement::saccade, EyeMovement::pursuit, EyeMovement::blink,
                         EyeMovement::lost, EyeMovement::unclassified, EyeMovement::microsaccade});
  gaze.since_saccade_ns = integer_of(value_of(text, "since_saccade_ns"));
  // Files of earlier versions state both: there, gaze on a screen has the default direction, straight ahead.
  facts.gaze_is_direction = !direction.empty() && (!has_place || direction != "0,0,-1");
  gaze.kind = facts.gaze_is_direction ? GazeKind::direction : GazeKind::screen;
  facts.gaze_true = gaze;
}

}  // namespace

FrameFacts read_frame_facts(const std::string& path) {
  FrameFacts facts;
  facts.settings_digest = read_settings_digest(path);
  if (path.ends_with(".exr")) {
    facts.exposure_ev = read_exr_number(path, "gazetrace:exposure_ev");
    facts.frames_per_second = read_exr_number(path, "framesPerSecond");
    facts.t_video_ns = integer_of(read_exr_text(path, "gazetrace:t_video_ns"));
    take_gaze(read_exr_text(path, "gazetrace:gaze_true"), facts);
  } else {
    const std::string note = read_image_note(path);
    facts.exposure_ev = number_from(value_of(note, "exposure_ev"));
    facts.t_video_ns = integer_of(value_of(note, "t_video_ns"));
    take_gaze(note, facts);
  }
  return facts;
}

}  // namespace gazetrace
