// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// Throws Error(usage) where two patterns are of the same kind.
OutputSettings output_settings(const JobSettings& job);
// With the frames that the job's times of a window hold.
AccumulateSettings accumulate_of(const JobSettings& job);
// Throws Error(input) where files cannot be created in the folders of the outputs, as far as that can be told without
// creating any.
void check_output_folders(const OutputSettings& output);

}  // namespace gazetrace
