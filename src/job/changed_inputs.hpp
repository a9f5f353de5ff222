// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// What is another than when the run of this record was made: files whose content changed, options, the version; "its
// inputs or settings" where the record does not tell, or is missing or damaged.
std::string changed_since(const std::string& record_path, const ResolvedJob& now);

// Error(usage) where finished frames would be rendered over, since they were made from other inputs: which frames, and
// what changed.
void refuse_to_lose_frames(const ResolvedJob& resolved, const std::string& record_path);

}  // namespace gazetrace
