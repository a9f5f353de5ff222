// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file_journal.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {
namespace {

std::string line_of(const std::string& name, const WrittenFile& file) {
  return fmt::format("{} {} {} {}\n", file.frame, file.bytes, file.digest, name);
}

[[noreturn]] void fail(const std::string& path) {
  throw Error(ErrorKind::runtime, path, std::string("writing failed: ") + std::strerror(errno),
              "free some space, or check the folder, and run again with `resume`");
}

}  // namespace

WrittenFiles read_earlier_files(const std::string& record_path) {
  WrittenFiles files;
  std::error_code ignored;
  if (std::filesystem::exists(record_path, ignored)) {
    try {
      files = read_run_record(record_path).files;
    } catch (const Error&) {
      files.clear();  // what is there of the pictures says the rest
    }
  }
  for (auto& [name, file] : read_file_journal(file_journal_name(record_path))) {
    files.insert_or_assign(name, file);
  }
  return files;
}

FileJournal::FileJournal(const std::string& record_path, WrittenFiles kept) : files_(std::move(kept)) {
  if (record_path.empty()) {
    return;
  }
  path_ = file_journal_name(record_path);
  std::string text;
  for (const auto& [name, file] : files_) {
    text += line_of(name, file);
  }
  write_text_atomically(path_, text);
  file_.reset(std::fopen(path_.c_str(), "ab"));
  if (!file_) {
    fail(path_);
  }
}

void FileJournal::add(const WrittenFiles& files) {
  std::string lines;
  for (const auto& [name, file] : files) {
    const auto known = files_.find(name);
    if (known == files_.end() || !(known->second == file)) {
      files_.insert_or_assign(name, file);
      lines += line_of(name, file);
    }
  }
  if (file_ && !lines.empty() &&
      (std::fwrite(lines.data(), 1, lines.size(), file_.get()) != lines.size() || std::fflush(file_.get()) != 0)) {
    fail(path_);
  }
}

void finish_files(const std::string& record_path) {
  std::error_code ignored;
  std::filesystem::remove(file_journal_name(record_path), ignored);
}

}  // namespace gazetrace
