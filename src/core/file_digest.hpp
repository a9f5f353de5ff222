// SPDX-License-Identifier: Apache-2.0
// Digests of content: whether a file is still the one that was read or written. Not for security.
#pragma once

#include <cstddef>
#include <fstream>
#include <span>
#include <string>

namespace gazetrace {

// 128 bits as 32 hex digits; of a file and of the bytes in it they are the same.
std::string digest_bytes(std::span<const std::byte> bytes);
// Error(input) for a folder and for what cannot be opened.
std::ifstream open_for_reading(const std::string& path);
// Error(input) for what cannot be opened, is a folder, or fails while it is read.
std::string digest_file(const std::string& path);

}  // namespace gazetrace
