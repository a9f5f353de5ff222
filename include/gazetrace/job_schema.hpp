// SPDX-License-Identifier: Apache-2.0
// The options of a job: the one definition of each. To add one, add a field to JobSettings and a definition to the file
// of src/job/schema/ that holds its neighbours.
#pragma once

#include "gazetrace/job_settings.hpp"
#include "gazetrace/option_schema.hpp"

namespace gazetrace {

using JobSchema = OptionSchema<JobSettings>;
// The heading of options that only machines need which share a sequence.
inline constexpr const char* kFarmHeading = "On many machines";
// Made once and never changed.
const JobSchema& job_schema();

// Parts of it that other commands have as well, under the same names.
OptionSchema<GazeFileSettings> gaze_choice_schema();           // the part of a log that is used
OptionSchema<GazeFileSettings> gaze_import_schema();           // that, and how a log is read: the importer's alone
OptionSchema<std::vector<std::string>> gaze_process_schema();  // the steps of processing
OptionSchema<ScreenSettings> screen_schema();                  // where the viewer sat
OptionSchema<ColorSettings> color_config_schema();             // the OpenColorIO config

}  // namespace gazetrace
