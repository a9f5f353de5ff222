// SPDX-License-Identifier: Apache-2.0
#include "job/confine.hpp"

#include <filesystem>
#include <system_error>
#include <vector>

#include "core/data_root.hpp"
#include "gazetrace/job_schema.hpp"
#include "job/toml_values.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// Some options take a name of ours or a file.
bool names_file(const Option& option, const std::string& value) {
  if (option.unit == "FILE" || option.unit == "PATTERN") {
    return true;
  }
  std::error_code ignored;
  return option.unit.find("FILE") != std::string::npos &&
         (value.find('/') != std::string::npos || fs::exists(value, ignored));
}

}  // namespace

void check_confined(const std::string& text, const std::string& path) {
  const std::vector<fs::path> roots = data_roots(path);
  const OptionList options = job_schema().list();
  for (const auto& [key, node] : parse_toml(text, path).members) {
    const Option* option = find_option(options, key);
    if (option == nullptr) {
      continue;  // the reader of settings says it better
    }
    for (const std::string& value : toml_values(node, *option, path)) {
      if (names_file(*option, value)) {
        check_within(roots, value, value, toml_place(path, node) + ": " + key,
                     "put the file there, or leave `confine` out where you trust the settings");
      }
    }
  }
}

}  // namespace gazetrace
