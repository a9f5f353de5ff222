// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "gazetrace/output.hpp"

namespace gazetrace {

// write_bytes_atomically(), and what proves the file later. The digest is of the bytes in memory, so that a disk that
// loses some of them is found out.
WrittenFile write_frame_file(const std::string& path, std::int32_t frame, std::span<const std::byte> bytes);

// How a record that lies in `directory` names a file, and where a file is that it names.
std::string name_in_record(const std::string& directory, const std::string& path);
std::string path_in_record(const std::string& directory, const std::string& name);

}  // namespace gazetrace
