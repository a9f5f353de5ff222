// SPDX-License-Identifier: Apache-2.0
// Errors of the library as Python's exceptions, in the same words.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

namespace gazetrace::python {

// The settings that a message names in back quotes become keywords: `gaze-start` becomes `gaze_start`.
std::string with_keywords(const std::string& text);
std::vector<std::string> in_keywords(std::vector<std::string> texts);  // the same for each

// From here on gazetrace::Error is raised as gazetrace.Error, with its kind.
void translate_errors();

}  // namespace gazetrace::python
