// SPDX-License-Identifier: Apache-2.0
// This program and this process, for records of a run.
#pragma once

#include <string>

namespace gazetrace {

double peak_memory_mib();         // of this process so far
std::string build_description();  // compiler and build type
std::string instruction_set();    // what the library was compiled for

}  // namespace gazetrace
