// SPDX-License-Identifier: Apache-2.0
// Named lists of settings. They stand in for the defaults: what a settings file or the command line gives goes over
// them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/option_table.hpp"

namespace gazetrace {

struct Preset {
  std::string name, description;
  std::vector<std::pair<std::string, std::string>> settings;  // option and its value
};
const std::vector<Preset>& presets();

// --preset NAME. To be added before the options that it sets; `table` and `name` must outlive the parsing.
void add_preset_option(OptionTable& table, std::string& name);

}  // namespace gazetrace
