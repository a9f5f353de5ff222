// SPDX-License-Identifier: Apache-2.0
#include "job/confine.hpp"

#include <filesystem>
#include <vector>

#include "core/data_root.hpp"
#include "gazetrace/job_schema.hpp"
#include "job/settings_paths.hpp"
#include "job/toml_values.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

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
        check_within(roots, located_file(*option, value, path).value, value, toml_place(path, node) + ": " + key,
                     "put the file there, or leave `confine` out where you trust the settings");
      }
    }
  }
}

}  // namespace gazetrace
