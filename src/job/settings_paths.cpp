// SPDX-License-Identifier: Apache-2.0
#include "job/settings_paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <vector>

#include "core/list_folder.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr std::array kWritten{"csv", "json", "output"};

bool is_read(const Option& option) {
  return option.unit.find("FILE") != std::string::npos &&
         std::find(kWritten.begin(), kWritten.end(), option.name) == kWritten.end();
}

// Of a sequence, whether the folder has a file that begins and ends like its names.
bool is_there(const fs::path& path) {
  std::error_code ignored;
  const std::string name = path.filename().string();
  if (!has_frame_number(name)) {
    return fs::exists(path, ignored);
  }
  const std::string begin = name.substr(0, name.find_first_of("#%<"));
  const std::string end = path.extension().string();
  const std::vector<fs::path> all = list_folder(path.parent_path(), ignored);
  return std::any_of(all.begin(), all.end(), [&](const fs::path& one) {
    const std::string found = one.filename().string();
    return found.starts_with(begin) && found.ends_with(end);
  });
}

// Where a settings file was named by its absolute path, what lies in the working folder keeps a relative name, so that
// records of a run do not depend on how its settings were named.
std::string within_working_folder(const fs::path& path) {
  std::error_code failed;
  const fs::path working = fs::current_path(failed);
  if (failed || !path.is_absolute()) {
    return path.string();
  }
  const fs::path relative = path.lexically_relative(working);
  return relative.empty() || *relative.begin() == ".." ? path.string() : relative.string();
}

}  // namespace

bool names_file(const Option& option, const std::string& value) {
  if (option.unit == "FILE" || option.unit == "PATTERN") {
    return true;
  }
  std::error_code ignored;
  return option.unit.find("FILE") != std::string::npos &&
         (value.find('/') != std::string::npos || value.ends_with(".csv") || value.ends_with(".exr") ||
          fs::is_regular_file(value, ignored));
}

LocatedFile located_file(const Option& option, const std::string& value, const std::string& settings_path) {
  const fs::path folder = fs::path(settings_path).parent_path();
  if (value.empty() || folder.empty() || !is_read(option) || fs::path(value).is_absolute() ||
      value.find("://") != std::string::npos) {
    return {value, {}};
  }
  const fs::path beside = (folder / value).lexically_normal();
  // A folder may have the name of a model, of which an option takes no files.
  const bool takes_folders = option.unit == "FILE" || option.unit == "PATTERN";
  std::error_code ignored;
  if (!takes_folders && (fs::is_directory(beside, ignored) || fs::is_directory(value, ignored))) {
    return {value, {}};
  }
  if (is_there(beside)) {
    return {within_working_folder(beside), {}};
  }
  if (!is_there(value)) {
    return {names_file(option, value) ? within_working_folder(beside) : value, {}};
  }
  return {value, fmt::format("'{}' is not there, and '{}' of the working folder is taken: paths in a settings file are "
                             "relative to that file",
                             beside.string(), value)};
}

}  // namespace gazetrace
