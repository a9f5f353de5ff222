// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <span>
#include <system_error>

#include "core/atomic_file.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

void check_output_file(const std::string& path, bool overwrite) {
  refuse_impossible_file(path);
  if (!overwrite && std::filesystem::exists(path)) {
    throw Error(ErrorKind::input, path, "this output exists already", "give `overwrite` or another name");
  }
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code problem;
  if (!folder.empty() && !std::filesystem::is_directory(folder) &&
      !std::filesystem::create_directories(folder, problem) && !std::filesystem::is_directory(folder)) {
    throw Error(
        ErrorKind::input, path,
        "the folder '" + folder.string() + "' cannot be made" + (problem ? ": " + problem.message() : std::string()),
        "choose another one");
  }
}

void write_text_atomically(const std::string& path, const std::string& text) {
  write_bytes_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace gazetrace
