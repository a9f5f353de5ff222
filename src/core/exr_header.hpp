// SPDX-License-Identifier: Apache-2.0
// Looks at the header of an EXR file before a library does: OpenEXR takes sizes in it at their word, and makes room for
// attributes of 2 GiB, blocks of lines and tiles of any width before anybody can ask it for them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace gazetrace {

// Error(input) at `place` where the header is cut, or states what its file cannot hold or what is larger than any
// picture that is read here. Nothing for what is no EXR.
void check_exr_header(std::span<const std::uint8_t> file_bytes, const std::string& place);
void check_exr_header(const std::string& path, const std::string& place);

}  // namespace gazetrace
