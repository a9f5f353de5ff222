// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// Error(usage) where two patterns are of one kind.
OutputSettings output_settings(const JobSettings& job);
// Error(input) where files cannot be made in the folders of the outputs or of the checkpoint, as far as that can be
// told without making any.
void check_output_folders(const OutputSettings& output, const std::string& checkpoint);

}  // namespace gazetrace
