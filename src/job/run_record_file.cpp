// SPDX-License-Identifier: Apache-2.0
#include "job/run_record_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// Error(input) where it cannot be read: then it could not be put back.
std::string record_text(const std::string& path) {
  if (std::filesystem::is_directory(path)) {
    throw Error(ErrorKind::input, path, "is a folder, not a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorKind::input, path, std::string("cannot be opened: ") + std::strerror(errno), "check the path");
  }
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

RunRecordFile::RunRecordFile(std::string path, Words words) : path_(std::move(path)), words_(std::move(words)) {
  if (!path_.empty() && std::filesystem::exists(path_)) {
    earlier_ = record_text(path_);
  }
}

void RunRecordFile::check_machine(const RunRecord& now, Warnings& warnings) const {
  if (path_.empty() || !std::filesystem::exists(path_)) {
    return;
  }
  RunRecord before;
  try {
    before = read_run_record(path_);
  } catch (const Error& error) {
    warnings.push_back(error.what());
    return;
  }
  if (before.denoiser != now.denoiser) {
    const auto name = [](const std::string& denoiser) { return denoiser.empty() ? "none" : denoiser; };
    throw Error(ErrorKind::input, path_,
                fmt::format("the frames so far were denoised by '{}', and those to come would be by '{}'",
                            name(before.denoiser), name(now.denoiser)),
                "render on with the same library and kind of machine, or anew with `overwrite`");
  }
  if (before.instruction_set != now.instruction_set || before.build != now.build ||
      before.ray_library != now.ray_library) {
    warnings.push_back(fmt::format(
        "{}: the run so far was made by '{}, {}, {}', this one is '{}, {}, {}'; frames may differ in their last bits",
        path_, before.build, before.instruction_set, before.ray_library, now.build, now.instruction_set,
        now.ray_library));
  }
}

void RunRecordFile::write(RunRecord record) const {
  if (path_.empty()) {
    return;
  }
  if (words_) {
    std::transform(record.warnings.begin(), record.warnings.end(), record.warnings.begin(), words_);
    for (auto& [name, text] : record.facts) {
      text = words_(text);
    }
  }
  write_text_atomically(path_, run_record_json(record));
}

void RunRecordFile::put_back() const {
  if (path_.empty()) {
    return;
  }
  if (!earlier_.empty()) {
    write_text_atomically(path_, earlier_);
    return;
  }
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace gazetrace
