// SPDX-License-Identifier: Apache-2.0
// The history between two frames in a file, from which a later run continues the sequence.
#pragma once

#include <string>

#include "gazetrace/temporal.hpp"

namespace gazetrace {

// Writes the history after a frame, to the bit, with the digest of the settings that it was made under. The file
// appears under its name only when it is complete. Error(runtime) where it cannot be written.
void save_checkpoint(const std::string& path, const TemporalHistory& history, const std::string& settings_digest);
// Error(input) where save_checkpoint() would replace a whole checkpoint of other settings, or any file that is no whole
// checkpoint, unless the run continues an earlier one (`goes_on`).
void check_checkpoint_target(const std::string& path, const std::string& settings_digest, bool goes_on);
// Error(input) for a file that is not a checkpoint, is damaged, or was made under other settings.
TemporalHistory load_checkpoint(const std::string& path, const std::string& settings_digest);

}  // namespace gazetrace
