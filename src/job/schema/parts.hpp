// SPDX-License-Identifier: Apache-2.0
// The parts of the schema of a job, in this order.
#pragma once

#include <string>

#include "gazetrace/job_schema.hpp"

namespace gazetrace {

// Larger values make no sense for any picture; within this range 2^stops times a bright light still fits into a float.
inline constexpr double kMaxStops = 64;

// Error(usage, place, ...) with the nearest known name of a filter, or with the option that takes this one: names of
// filters are taken for those of densities, and `linear` is of both. "auto" is a name, too.
void check_filter_name(const std::string& name, const std::string& place);

void add_scene_options(JobSchema& schema);
void add_camera_options(JobSchema& schema);
void add_gaze_options(JobSchema& schema);
void add_screen_options(JobSchema& schema);
void add_frame_options(JobSchema& schema);
void add_sampling_options(JobSchema& schema);
void add_filter_options(JobSchema& schema);
void add_window_options(JobSchema& schema);
void add_tracing_options(JobSchema& schema);
void add_color_options(JobSchema& schema);
void add_output_options(JobSchema& schema);
void add_talk_options(JobSchema& schema);
void add_limit_options(JobSchema& schema);
void add_farm_options(JobSchema& schema);

}  // namespace gazetrace
