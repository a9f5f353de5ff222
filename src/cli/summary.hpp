// SPDX-License-Identifier: Apache-2.0
// What a finished run says of itself.
#pragma once

#include <string>

#include "gazetrace/run_job.hpp"

namespace gazetrace {

// Frames, mean time by stage, samples and speed; several lines.
std::string summary_text(const SequenceResult& result, double wall_s);
std::string summary_json(const FinishedRun& run);

}  // namespace gazetrace
