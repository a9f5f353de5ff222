// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace gazetrace {

// Replaces every {{name}} of a template; names inside of what is put in are left alone. A name without a value is a
// mistake of the program and throws std::out_of_range.
std::string fill_template(std::string_view text, const std::map<std::string, std::string>& values);

// JSON for the inside of a <script>: it has no "<", so that neither an end tag nor a comment can begin in it.
std::string script_safe(const std::string& json);

}  // namespace gazetrace
