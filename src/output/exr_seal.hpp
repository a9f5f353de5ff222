// SPDX-License-Identifier: Apache-2.0
// A digest of an EXR file within its own header, so that a picture whose record was lost can still tell damage.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <cstddef>
#include <span>
#include <string>

namespace gazetrace {

// Makes room for the digest in a header that is to be written.
void add_room_for_seal(Imf::Header& header);
// Writes the digest of the whole file, in which its own place holds zeros, to that place. Nothing where there is none.
void seal_exr(std::span<std::byte> file_bytes);
// Whether the file has a seal, and is as it was written.
bool has_whole_seal(const std::string& path);

}  // namespace gazetrace
