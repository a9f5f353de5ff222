// SPDX-License-Identifier: Apache-2.0
#include "core/enum_name.hpp"
#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

const std::vector<EventPreset>& event_presets() {
  static const std::vector<EventPreset> kPresets{
#define EVENT_PRESET(name, device, description, ...) \
  EventPreset{name, description, GazeDevice::device, EventSettings{__VA_ARGS__}},
#include "gaze/events/presets.def"
#undef EVENT_PRESET
  };
  return kPresets;
}

const EventPreset& event_preset(std::string_view name) {
  std::vector<std::string> known;
  for (const EventPreset& preset : event_presets()) {
    if (preset.name == name) {
      return preset;
    }
    known.push_back(preset.name);
  }
  throw Error(ErrorKind::usage, "", unknown_name_message("event method", name, known));
}

const EventPreset& default_event_preset(const GazeLog& log, std::optional<GazeDevice> device) {
  return event_preset(device.value_or(recorded_device(log)) == GazeDevice::desktop ? "ivt"
                      : log.head.empty()                                           ? "ivt-attention"
                                                                                   : "ivt-hmd");
}

GazeDevice recorded_device(const GazeLog& log) {
  return log.device.value_or(log.kind == GazeKind::screen ? GazeDevice::desktop : GazeDevice::head_mounted);
}

std::string_view to_string(GazeSpace space) {
  return space == GazeSpace::head ? "head" : "world";
}

std::string_view to_string(EyeMovement movement) {
  return name_of(movement, {"fixation", "saccade", "pursuit", "blink", "lost", "unclassified", "microsaccade"});
}

}  // namespace gazetrace
