// SPDX-License-Identifier: Apache-2.0
#include "job/confine.hpp"

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/data_root.hpp"
#include "core/list_folder.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/job_schema.hpp"
#include "gazetrace/output.hpp"
#include "job/settings_paths.hpp"
#include "job/toml_values.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// What a name with a place for the frame's number can lead to by symbolic links: the files that it stands for, and what
// lies in the folder above the first folder whose name has such a place.
std::vector<std::string> meanings(const std::string& pattern) {
  std::vector<std::string> names;
  fs::path above;
  const fs::path folders = fs::path(pattern).parent_path();
  for (const fs::path& part : folders) {
    if (has_frame_number(part.string())) {
      for (const fs::path& found : list_folder_if_there(above)) {
        names.push_back(found.string());
      }
      break;
    }
    above /= part;
  }
  try {
    for (const std::int32_t frame : find_frames(pattern)) {
      names.push_back(frame_file_name(pattern, frame));
    }
  } catch (const Error&) {
    // There are none yet.
  }
  return names;
}

}  // namespace

void check_confined(const Option& option, const std::vector<std::string>& values, const std::string& path,
                    const std::string& place) {
  const std::string at = place + ": " + option.name;
  if (option.name == "allow-outside" && values != std::vector<std::string>{"false"}) {
    throw Error(ErrorKind::input, at, "settings that are not trusted cannot let scenes out of their folder",
                "give `allow-outside` yourself, or leave `confine` out where you trust the settings");
  }
  for (const std::string& value : values) {
    if (!names_file(option, value)) {
      continue;
    }
    const std::vector<fs::path> roots = data_roots(path);
    const char* remedy = "put the file there, or leave `confine` out where you trust the settings";
    check_within(roots, value, value, at, remedy);
    if (has_frame_number(value)) {
      for (const std::string& name : meanings(value)) {
        check_within(roots, name, name, at, remedy);
      }
    }
  }
}

void check_confined(const std::string& text, const std::string& path, const std::string& remedy) {
  const OptionList options = job_schema().list();
  const TomlNode root = parse_toml(text, path);
  const std::vector<OptionText> given = given_in(root, path);
  for (const auto& [key, node] : root.members) {
    for (const TomlSetting& setting :
         toml_settings(key, node, given, options, path, remedy, PathsBegin::beside_settings, TomlChecks::names)) {
      check_confined(*find_option(options, setting.name), setting.values, path, setting.place);
    }
  }
}

}  // namespace gazetrace
