// SPDX-License-Identifier: Apache-2.0
// What is done to a glTF file's JSON before anything reads it.
#pragma once

#include <string_view>

#include "scene/gltf/walker.hpp"

namespace gazetrace {

inline constexpr int kMaxJsonDepth = 200;

// Deeper JSON than any exporter writes would overflow the stack of parsers that recurse.
bool is_nested_too_deep(std::string_view text);

// "Integers may be stored as decimals with a zero fractional part" (glTF 2.0 section 3.2), which the parser refuses. In
// extensions it cuts integers to 32 bits, but not decimals: larger numbers are integers only where sizes stand.
void tidy_numbers(Json& root);

}  // namespace gazetrace
