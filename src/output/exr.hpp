// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gazetrace {

const std::vector<std::string>& exr_compression_names();
// Whether values may change a little: fine for light, and fatal to numbers that are compared bit by bit.
bool is_lossy_compression(const std::string& name);

// The value of a string attribute; empty where the file is not an EXR, lacks the attribute, or is truncated.
std::string read_exr_text(const std::string& path, const std::string& attribute);
// A number in the header, stored as a double or as a fraction; empty where there is none.
std::optional<double> read_exr_number(const std::string& path, const std::string& attribute);
// A whole number in the header; empty where there is none.
std::optional<std::int32_t> read_exr_integer(const std::string& path, const std::string& attribute);

}  // namespace gazetrace
