// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace gazetrace {

// Replaces every {{name}} of a template; what is put in is not looked at again. A name without a value is a mistake of
// the program: std::out_of_range.
std::string fill_template(std::string_view text, const std::map<std::string, std::string>& values);

// JSON inside a <script>: no "<", so neither an end tag nor a comment can begin in it.
std::string script_safe(const std::string& json);

}  // namespace gazetrace
