// SPDX-License-Identifier: Apache-2.0
// Looks at JPEG files before a library does: libjpeg's readers keep every comment and application segment in a list
// that they walk for each new one, so that the time of a file that is full of them is the square of its size.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gazetrace {

// A copy without the segments that do not concern the picture or its note. Error(input) at `place` where it has more
// scans than any encoder writes, each of which is a pass over all pixels. What is cut is left for libjpeg to judge.
std::vector<std::uint8_t> essential_jpeg(std::span<const std::uint8_t> file_bytes, const std::string& place);

}  // namespace gazetrace
