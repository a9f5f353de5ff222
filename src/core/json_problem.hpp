// SPDX-License-Identifier: Apache-2.0
// What is wrong with a JSON text, in words of our own.
#pragma once

#include <string>
#include <string_view>

namespace gazetrace {

// The JSON library's message without its own names and grammar: "line 1, column 8: the text ends too early",
// "line 3, column 2: it cannot go on with 'x'", "key 'frames' not found".
std::string json_problem(std::string_view message);

}  // namespace gazetrace
