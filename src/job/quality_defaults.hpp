// SPDX-License-Identifier: Apache-2.0
// The sampling that follows from what is stated where nobody names one.
#pragma once

#include "gazetrace/job.hpp"

namespace gazetrace {

// Where neither options nor a preset name a sampling: adaptive for a stated quality, regions for what is stated of
// them, else the density of JobSettings. The choice is added to `decisions`, if there are any.
Job with_quality_defaults(Job job, Decisions* decisions = nullptr);

}  // namespace gazetrace
