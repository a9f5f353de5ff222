// SPDX-License-Identifier: Apache-2.0
#include "job/confine.hpp"

#include <filesystem>
#include <vector>

#include "core/data_root.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/job_schema.hpp"
#include "job/settings_paths.hpp"
#include "job/toml_values.hpp"

namespace gazetrace {

void check_confined(const Option& option, const std::vector<std::string>& values, const std::string& path,
                    const std::string& place) {
  const std::string at = place + ": " + option.name;
  if (option.name == "allow-outside" && values != std::vector<std::string>{"false"}) {
    throw Error(ErrorKind::input, at, "settings that are not trusted cannot lift what holds scenes to their folder",
                "give `allow-outside` yourself, or leave `confine` out where you trust the settings");
  }
  for (const std::string& value : values) {
    if (names_file(option, value)) {
      check_within(data_roots(path), value, value, at,
                   "put the file there, or leave `confine` out where you trust the settings");
    }
  }
}

void check_confined(const std::string& text, const std::string& path) {
  const OptionList options = job_schema().list();
  for (const auto& [key, node] : parse_toml(text, path).members) {
    // The reader of settings says it better where there is no such option.
    if (const Option* option = find_option(options, key)) {
      std::vector<std::string> values = toml_values(node, *option, path);
      for (std::string& value : values) {
        value = located_file(*option, value, path).value;
      }
      check_confined(*option, values, path, toml_place(path, node));
    }
  }
}

}  // namespace gazetrace
