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

void take_gaze(const std::string& text, FrameFacts& facts) {
  facts.gaze_state = value_of(text, "state");
  facts.gaze_event = value_of(text, "event");
  facts.is_without_gaze = value_of(text, "no_gaze") == "1";
  const std::optional<double> u = number_from(value_of(text, "u"));
  const std::optional<double> v = number_from(value_of(text, "v"));
  // Places on a screen leave the direction straight ahead, directions leave the place in the middle.
  facts.gaze_is_direction = !text.empty() && value_of(text, "direction") != "0,0,-1";
  const bool usable = facts.gaze_state != to_string(GazeState::none) && !facts.is_without_gaze;
  if (u && v && usable && !facts.gaze_is_direction) {
    facts.gaze_uv = Vec2d{*u, *v};
  }
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
  }
  return facts;
}

}  // namespace gazetrace
