// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gazetrace/option_schema.hpp"

namespace gazetrace {

// Error(input) where a settings file that is not trusted (`confine`) names a file to read or to write outside of its
// own folder, or of the data set that it belongs to. Nothing that it names is opened. `text`: the file's content;
// `remedy`: as for read_toml_settings(), which throws where the file is wrong.
void check_confined(const std::string& text, const std::string& path, const std::string& remedy);
// The same for one option of such a file. `values`: as located_file() gives them, which must not be asked a second
// time: what leads out of the folder of `path` would be looked for from within it again. `place`: the line that gives
// it.
void check_confined(const Option& option, const std::vector<std::string>& values, const std::string& path,
                    const std::string& place);

}  // namespace gazetrace
