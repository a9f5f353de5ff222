// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace gazetrace {

// Under its name only when complete. Error(runtime).
void write_whole_file(const std::string& path, std::string_view bytes);

}  // namespace gazetrace
