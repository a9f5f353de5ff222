// SPDX-License-Identifier: Apache-2.0
// This program and this process, for records of a run.
#pragma once

#include <string>

namespace gazetrace {

double peak_memory_mib();         // of this process so far
std::string build_description();  // compiler, whether code is optimised, and whether assertions are on
std::string instruction_set();    // the target of the compilation

}  // namespace gazetrace
