// SPDX-License-Identifier: Apache-2.0
// The files of a run while it goes on: a line for each as soon as it is written, so that a killed run knows its files.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "gazetrace/output.hpp"

namespace gazetrace {

// What an earlier run with this record wrote, by its record and its journal; nothing where these are damaged.
WrittenFiles read_earlier_files(const std::string& record_path);

class FileJournal {
 public:
  // The journal begins with the files that are kept. With an empty path of the record nothing is written.
  FileJournal(const std::string& record_path, WrittenFiles kept);

  // Adds those of `files` that are new, or another content of the same frame's file.
  void add(const WrittenFiles& files);
  [[nodiscard]] const WrittenFiles& files() const { return files_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  std::string path_;
  WrittenFiles files_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace gazetrace
