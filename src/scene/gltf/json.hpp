// SPDX-License-Identifier: Apache-2.0
// Checks and tidies the JSON of a glTF file before anything else reads it.
#pragma once

#include <cstdint>
#include <string_view>

#include "scene/gltf/walker.hpp"

namespace gazetrace {

// Whether the JSON is nested deeper than this; nesting without a limit would overflow the stack of recursive parsers.
bool is_nested_too_deep(std::string_view text, int most);

// What the tree of values takes, in bytes and from above, by the commas, brackets and colons of the text: "[]," is
// three bytes and eighty in memory. With it the copy of the text that is handed on.
std::uint64_t json_memory_bytes(std::string_view text);

// Adapts numbers to what the parser expects. "Integers may be stored as decimals with a zero fractional part" (glTF 2.0
// section 3.2), which it refuses. In extensions it truncates integers to 32 bits, but not decimals, so larger numbers
// remain integers only where sizes are stored.
void tidy_numbers(Json& root);

}  // namespace gazetrace
