// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/job_schema.hpp"

#include "job/preset_by_name.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

// What the options touch that presets set.
constexpr Touches kOfPresets =
    Touch::sampling | Touch::tracing | Touch::filter | Touch::window | Touch::color | Touch::output;

// set_option() also sets the options that the preset consists of.
void add_preset_option(JobSchema& schema) {
  schema.group("Presets");
  OptionOf<JobSettings>& option =
      schema
          .value("--preset", &JobSettings::preset, "NAME", kOfPresets,
                 "A named list of settings ('gazetrace list presets'). Given on the command line it overrides a "
                 "settings file, but not the other options of the command line; given in a settings file it is "
                 "overridden by the rest of the file")
          .with(Trait::everyday);
  option.decides_nothing();
  static const OptionType kNameOfPreset = [] {
    OptionType type = option_type<std::string>();
    type.check = [](const auto& values, const auto& place) { (void)preset_by_name(values.at(0), place); };
    return type;
  }();
  option.type = &kNameOfPreset;
}

JobSchema make_schema() {
  JobSchema schema;
  add_preset_option(schema);
  add_output_options(schema);
  add_scene_options(schema);
  add_camera_options(schema);
  add_gaze_options(schema);
  add_screen_options(schema);
  add_frame_options(schema);
  add_sampling_options(schema);
  add_filter_options(schema);
  add_window_options(schema);
  add_tracing_options(schema);
  add_color_options(schema);
  add_talk_options(schema);
  add_limit_options(schema);
  add_farm_options(schema);
  return schema;
}

}  // namespace

const JobSchema& job_schema() {
  static const JobSchema schema = make_schema();
  return schema;
}

}  // namespace gazetrace
