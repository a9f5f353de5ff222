// SPDX-License-Identifier: Apache-2.0
// When options of a job have no effect because of the others.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/job_schema.hpp"

namespace gazetrace {

using JobIdleRule = IdleRule<JobSettings>;

bool has_gaze_log(const JobSettings& job);
bool has_gaze(const JobSettings& job);  // from a log or fixed

JobIdleRule without_gaze();
// Without gaze, except for a sampling that follows a picture.
JobIdleRule without_density();
JobIdleRule without_gaze_log();
JobIdleRule with_uniform();
JobIdleRule with_regions();
JobIdleRule without_regions();
JobIdleRule without_window();
// No AOV whose name begins so is asked for.
JobIdleRule without_aov(const std::string& name);
JobIdleRule without_coverage();  // which mattes and alpha show
JobIdleRule without_automatic_exposure();
JobIdleRule with_lights_sampled_alone();
JobIdleRule with_other_sampling(const std::string& name);

}  // namespace gazetrace
