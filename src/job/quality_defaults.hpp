// SPDX-License-Identifier: Apache-2.0
// What a stated quality chooses where nobody else has.
#pragma once

#include "gazetrace/job.hpp"

namespace gazetrace {

// Rates of the default sampling, regions, are given and do not follow from a quality. Where neither options nor a
// preset name a sampling, it is adaptive. The choice is added to `decisions`, if there are any.
Job with_quality_defaults(Job job, Decisions* decisions = nullptr);

}  // namespace gazetrace
