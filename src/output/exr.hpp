// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace gazetrace {

const std::vector<std::string>& exr_compression_names();

// The value of a string attribute; empty where the file is no EXR, lacks the attribute or lacks its last pixels.
std::string read_exr_text(const std::string& path, const std::string& attribute);
// A number of the header: a double, or a fraction as its value. Empty where there is none.
std::optional<double> read_exr_number(const std::string& path, const std::string& attribute);

}  // namespace gazetrace
