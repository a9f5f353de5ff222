// SPDX-License-Identifier: Apache-2.0
// PNG files before libpng sees them: it prints what it finds wrong, past any caller.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gazetrace {

bool is_png(std::span<const std::uint8_t> file_bytes);

// The same picture as a file of only the chunks that its pixels need (IHDR, PLTE, tRNS, IDAT, IEND), each with a
// checksum that is right: no chunk of anything else is there to complain of, an old colour profile for one.
// Error(input) at `place` for a header, palette, checksum or order of chunks that PNG (ISO/IEC 15948) does not allow,
// and for a file that ends early. What the pixels' stream holds is not looked at.
std::vector<std::uint8_t> essential_png(std::span<const std::uint8_t> file_bytes, const std::string& place);

}  // namespace gazetrace
