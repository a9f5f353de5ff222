// SPDX-License-Identifier: Apache-2.0
// A run's claims to the files that it writes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gazetrace/resolve.hpp"
#include "gazetrace/run_lock.hpp"

namespace gazetrace {

// Of the record, and of the pictures where they go: another run may write pictures of the same names beside a record
// that lies elsewhere. Other runs are waited for, which people are told of; the outputs are then prepared once more.
// `files` are output_files(): without any nothing is claimed.
std::vector<std::unique_ptr<RunLock>> lock_outputs(const ResolvedJob& resolved, const std::vector<std::string>& files);

}  // namespace gazetrace
