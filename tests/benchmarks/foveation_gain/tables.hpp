// SPDX-License-Identifier: Apache-2.0
// From rows to what is won and lost.
#pragma once

#include <string>
#include <vector>

namespace gazetrace::gain {

// A summary to standard output; every model, filter, band, rival and metric with its interval into `full_path`, where
// that is not empty.
void print_tables(const std::vector<std::string>& files, const std::string& full_path);

}  // namespace gazetrace::gain
