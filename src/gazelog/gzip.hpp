// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace gazetrace {

bool is_gzip(std::string_view bytes);
// Unpacks all members of a gzip file. Throws Error(input) at `path` for damaged or cut data, and for data that unpack
// to more than `most_bytes` or more than any recording does (400 times their size and 16 MiB).
std::string unpack_gzip(std::string_view bytes, const std::string& path, std::uint64_t most_bytes);

// Packs one member without name and time, so that the same text gives the same bytes.
std::string pack_gzip(std::string_view text);

}  // namespace gazetrace
