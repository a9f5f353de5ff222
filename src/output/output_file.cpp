// SPDX-License-Identifier: Apache-2.0
// Which files a command may write, decided in one place for all commands; and how text is written.
#include <fmt/format.h>
#include <sys/stat.h>

#include <filesystem>
#include <set>
#include <span>
#include <system_error>

#include "core/atomic_file.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

struct Place {
  std::string identity;  // one for all names of a file: links to it and other ways of writing its path
  bool exists = false;
};

Place place_of(const std::string& path) {
  struct stat state {};
  if (::stat(path.c_str(), &state) != 0) {
    // Links in the folder's name count, and a link that leads nowhere is there.
    std::error_code problem;
    const fs::path real = fs::weakly_canonical(fs::absolute(path), problem);
    return {(problem ? fs::absolute(path).lexically_normal() : real).string(), ::lstat(path.c_str(), &state) == 0};
  }
  return {fmt::format("{}:{}", state.st_dev, state.st_ino), true};
}

// Of files, and of the frames that patterns stand for.
std::set<std::string> identities_of(const std::vector<std::string>& inputs) {
  std::set<std::string> all;
  for (const std::string& input : inputs) {
    if (input.empty()) {
      continue;
    }
    const Place place = place_of(input);
    all.insert(place.identity);
    if (place.exists) {
      continue;
    }
    try {
      if (!has_frame_number(input)) {
        continue;
      }
      for (const std::int32_t frame : find_frames(input)) {
        all.insert(place_of(frame_file_name(input, frame)).identity);
      }
    } catch (const Error&) {  // no pattern, or no frames of it: whoever reads them says so
      continue;
    }
  }
  return all;
}

void make_folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  std::error_code problem;
  if (!folder.empty() && !fs::is_directory(folder) && !fs::create_directories(folder, problem) &&
      !fs::is_directory(folder)) {
    throw Error(
        ErrorKind::input, path,
        "the folder '" + folder.string() + "' cannot be made" + (problem ? ": " + problem.message() : std::string()),
        "choose another one");
  }
}

}  // namespace

void check_outputs(std::vector<std::string> outputs, const std::vector<std::string>& inputs, bool may_replace,
                   const std::string& remedy) {
  std::erase(outputs, std::string());
  const std::set<std::string> read = identities_of(inputs);
  std::set<std::string> written;
  for (const std::string& output : outputs) {
    const Place place = place_of(output);
    refuse_impossible_file(output);
    if (read.contains(place.identity)) {
      throw Error(ErrorKind::usage, output, "this output would replace an input", "give another name");
    }
    if (!written.insert(place.identity).second) {
      throw Error(ErrorKind::usage, output, "two outputs have this name", "give each its own");
    }
    if (place.exists && !may_replace) {
      throw Error(ErrorKind::input, output, "this output exists already", remedy);
    }
  }
  for (const std::string& output : outputs) {
    make_folder_of(output);
  }
}

void write_text_atomically(const std::string& path, const std::string& text) {
  write_bytes_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace gazetrace
